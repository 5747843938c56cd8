"""Contact stiffness from measured stick frequencies and a reduced model of the joint.

In: stick frequencies, a parametric model, the gauge. Out: (kn, kt) at each force (`search`, on
frequencies tabulated over kn and kt by `map` and interpolated by `surface`; `grid_search` as the
thesis does it; `summary` of all) and over all forces (`joint`: a `model` of the measured `levels`
under `laws`, whose fit and draws `posterior` tells; `amplitude` with the curves of `softening`
besides). Priors of this room stand in `priors`. Read `search` or `joint` first. Fits and draws are
those of `bladeroot.inference`; `variables.csv` says what each output variable is.
"""
