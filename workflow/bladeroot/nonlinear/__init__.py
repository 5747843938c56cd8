"""Amplitude-dependent frequency and damping of the joint with friction at its flanks.

A small system around one stuck mode (`system`), its periodic motion by harmonic balance or by
quasi-static loading, and the curves of frequency and loss factor that follow (`backbone`).
In: a joint with its contact stiffness, and a law of friction. Out: a Dataset of curves. Read
`system` first.
"""
