"""The own monotone interpolation beside scipy's."""

import numpy as np
import pytest
from bladeroot.nonlinear.pchip import evaluate, pieces
from scipy.interpolate import PchipInterpolator


@pytest.mark.parametrize("knots", [3, 4, 30])
def test_pieces_and_values_are_those_of_scipy(knots):
    rng = np.random.default_rng(knots)
    x = np.cumsum(rng.uniform(0.1, 1.0, knots))
    rising, turning = np.cumsum(rng.exponential(size=(2, knots, 5)), axis=1)
    turning[::2] *= -1.0
    y = np.hstack([rising, turning, np.round(turning), np.zeros((knots, 1))])
    theirs, own = PchipInterpolator(x, y, axis=0), pieces(x, y)
    np.testing.assert_allclose(own, theirs.c, rtol=1e-12, atol=1e-12)
    at = np.linspace(x[0] - 0.2, x[-1] + 0.2, 50)
    np.testing.assert_allclose(evaluate(x, own, at), theirs(at), rtol=1e-12, atol=1e-12)
