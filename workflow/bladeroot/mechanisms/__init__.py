"""The catalogue of possible causes, one file each, on one interface (`mechanism.Mechanism`).

In: the records' or points' situations and values of parameters. Out: changes and their derivatives.
Read `mechanism` first, then a short file such as `force_offset`. Prior and limits of a cause's size
stand in its own file; `catalogue` finds all files that have a `MECHANISM`, helpers have none.
"""
