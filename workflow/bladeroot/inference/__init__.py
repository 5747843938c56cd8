"""The engine of inference: a model that gives mean, Jacobian and covariance is fitted and sampled.

In: a `Problem`: data, a model of them, priors of its parameters (which the rooms that ask bring
along). Out: a `Fit`. `problem` (read first): what is fitted. `gaussian`: MAP estimate by
Gauss-Newton steps of bounded length, Laplace evidence. `marginal`: moments along a ridge.
`hold_out`: data that a fit has not seen. `sampling`: weighted draws of the posterior with their
effective number. `least_squares`: contact stiffness of one load from any number of modes, with its
chi-square.
"""
