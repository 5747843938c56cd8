"""The virtual test bench: raw velocity records of a ring-down, as the real machine would make them.

The room shares nothing with the rooms that infer: the joining of beam, slots and springs, the
friction of the flanks and the integration in time are its own. Its truth is one file,
`resources/bench/rig.yaml`, which no inference reads. Read `bench` first.
"""
