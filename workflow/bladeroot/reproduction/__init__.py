"""All that is the thesis: its numbers beside ours, its search, and the fits to its tables.

No room but `public`, whose configuration may ask for the thesis's filters, imports this one.
`build` (read first) makes the ledger: an entry of `resources/thesis/ledger.yaml` names a quantity
of `quantities`, and the verdict follows from numbers and tolerance (`entry`). `calibration` fits
unpublished dimensions to printed tables on `bladeroot.inference`; `tension` says which tables
contradict each other; `thesis_search` is the source's own search, `thesis_filters` its estimate of
a decay, `error_bounds` its Appendix F, `structure_checks` its tables of frequencies.
`variables.csv` says what each output variable is.
"""
