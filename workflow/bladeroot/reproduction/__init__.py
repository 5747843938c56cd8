"""All that is the thesis: its numbers beside ours, its search, and the fits to its tables.

Nothing imports this room. `build` makes the ledger: an entry of `resources/thesis/ledger.yaml`
names a quantity of `quantities`, and the verdict follows from numbers and tolerance. `calibration`
fits unpublished dimensions to printed tables; `thesis_search` is the source's own search.
"""
