"""The engine of inference: MAP estimate, Laplace evidence and hold-out of Gaussian models.

In: a model that gives mean, Jacobian and covariance, with priors. Out: a `Fit` (`gaussian`).
"""
