"""What the simulation gets wrong, which mechanism explains it, and what is gained by adding it.

In: records as one table (`observations`), what they are judged against (`simulation`) and
mechanisms. Out: a Dataset, the verdict (`verdict`; its sentences are `report.verdict`'s) and a
model file (`extension`), all from `judged`. Read `diagnose` first, then `naming`: each kind of data
is a `channel` with its model (`stick_model`, `damping_model`, `curve_model`; causes act together by
`causes`), for which sets of causes are weighed (`families`, `posterior`). `gain` holds data out,
`next_measurement` says which of the `options` to measure next. `guards` holds the thresholds that
decide on names, among them from which probability on a cause is certain. Priors of causes stand in
`mechanisms`, those of kn and kt in `stiffness.priors`, those of damping in `damping_model`, those
of a simulation without kn and kt in its file of `simulation`.
"""
