"""Hidden effects, one file each: what it is, its size, how it changes a record's conditions.

A file has CLASS (of the diagnosis' answer; `outside` if no catalogue has it), UNIT, BOUND (the
smallest size that must be found), SIGNED (whether either sign occurs) and `change`. TUNED, where
the size is what the effect does rather than its cause: `tests/blind/tuning.py` finds the cause.
"""
