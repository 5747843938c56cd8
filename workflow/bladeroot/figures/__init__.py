"""Figures: one small file a stage, each with functions that the report calls.

In: Datasets. Out: a `Chart` (data of panels and traces, which `live` and `still` draw), or a
matplotlib Figure where a picture is no chart. Read `chart` first: an axis is a `Panel` in the
stage's file. `style` is the look that all share.

Of records: `records` and `spectra` (raw), `curves` (measured frequency and loss factor over
amplitude), `stick` (over the load). Of structures: `structure`, `shapes`. Of kn and kt:
`stiffness`, `joint`, `nonlinear` (simulated curves over amplitude), `theory`. Of the diagnosis:
`diagnosis`, `residual_maps`. Of the thesis alone: `slider`, `thesis_search`.
"""
