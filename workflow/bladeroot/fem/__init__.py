"""The finite-element bodies of the dovetail: geometry, 27-node hexahedra, prestress.

In: a structure file. Out: mesh (`mesh`), mass, stiffness and geometric stiffness (`elasticity`,
`prestress`). Read `mesh` first.
"""
