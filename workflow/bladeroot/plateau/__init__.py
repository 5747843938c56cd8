"""The stick plateau of one decay: where frequency and damping are constant, and where slip begins.

In: the curves of one decay. Out: stick frequency, loss factor and onset of slip with their errors.
Read `plateau` first; laws that the decay may follow (`laws`) are weighed by evidence (`weigh`, with
`evidence` and `posterior`) on groups of blocks (`segment`).
"""
