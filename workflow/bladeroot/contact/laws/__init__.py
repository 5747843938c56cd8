"""Contact laws: each file makes the `Sliders` of one law; force and Jacobian are shared."""
