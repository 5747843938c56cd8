"""Reduced models: from bodies or given matrices to frequencies over (kn, kt, force).

In: meshes with matrices, or matrices of another program (`external`). Out: a Craig-Bampton model
that serves every force (`reduction`), one joined model a force (`assembly`), and the parametric
model with its error bound (`parametric`). Read `joint` first; `checks` holds the beam to
exact identities.
"""
