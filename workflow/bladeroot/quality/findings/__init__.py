"""The checks of a decay, one file a finding.

A file `x_y.py` defines the finding `x-y` by one function, `find(seen) -> Finding | None`: the
strongest candidate with its statistic (which `quality.integrity` compares with the threshold), or
None where the record is too short to judge. Beside it stand `THRESHOLD` and `STATISTIC`, what
the statistic is in a phrase. A file with `FIRST = True` is run before the others, which then see
the record with what it masked bridged. One with `MIXED = True` looks at all that rings; the others
see the mode by itself. One that leftovers of other modes may set off is listed in `LIKE_LEFTOVERS`
of `quality.integrity`. `without_decay(seen)` returns a line of text for a record in which no decay
was found. A file may name some of its findings otherwise (`Finding.name`), as `shaker_recontact`
does with a gap.
"""
