"""A sensor's own response to the motion, undone: one file a kind, found by itself.

`high_pass.py` is the kind `high-pass`: `undone(samples, sampling_Hz, corner_Hz) -> samples`.
"""
