"""Bring your own model: matrices, node tables and contact pairs of another finite-element program.

A structure file of kind `matrices` (schemas/matrices.schema.yaml) names them; what comes out are
the same nodes and the same reduced beam and slots as of the built-in dovetail.
"""
