"""The prestressed blade root and its slots: geometry, 27-node hexahedra, reduction, assembly.

A structure file becomes a mesh (`mesh`), mass, stiffness and geometric stiffness (`elasticity`,
`prestress`), a Craig-Bampton model that serves every axial force (`reduction`), and one joined
model a force (`assembly`). A load that follows the flanks is an option (`follower`). `checks`
compares all of it with the published tables; `shapes` are the beam's modes to be drawn.
"""
