"""Contact theory of a flat punch with rounded edges on a half-space.

From the geometry of one flank to pressure, shear, normal and tangential approach, and from these
to the incremental contact stiffness against the normal force and against the axial force.
In: a punch and a load. Out: Datasets (`theory`, which puts together the pressure of `punch` and the
approach and stiffness of `compliance`); friction laws are in `laws`. Read `punch` first.
"""
