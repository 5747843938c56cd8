"""The engine of inference: a model that gives mean, Jacobian and covariance is fitted and sampled.

`gaussian` (read first): priors, damped Gauss-Newton MAP estimate, Laplace evidence. `hold_out`:
data that a fit has not seen.
`sampling`: weighted draws of the posterior with their effective number. `least_squares`: contact
stiffness of one load from any number of modes, with its chi-square.
"""
