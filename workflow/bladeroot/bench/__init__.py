"""The virtual test bench: raw velocity records of a ring-down, as the real machine would make them.

The room shares nothing with the rooms that infer: the joining of beam, slots and springs, the
friction of the flanks and the integration in time are its own. In: the rig's truth, one file
(`resources/bench/rig.yaml`) that no inference reads, a structure's parts, a row of the sheet. Out:
a raw record, and what is true of it. Read `bench` first; what may be hidden is a file of `effects`.
"""
