"""Monotone cubics against SciPy's."""

import numpy as np
from bladeroot.nonlinear.monotone import interpolated, pieces
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator


@settings(deadline=None, max_examples=30)
@given(st.integers(3, 40), st.integers(0, 2**32 - 1))
def test_cubics_are_those_of_scipy(count, seed):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.uniform(0.1, 2.0, count))
    # free, rising, with level parts, level
    y = rng.standard_normal((count, 4))
    y[:, 1:] = np.cumsum(np.abs(y[:, 1:]), axis=0)
    y[:, 2], y[:, 3] = np.round(y[:, 2]), 1.0
    known = PchipInterpolator(x, y, axis=0)
    np.testing.assert_allclose(pieces(x, y), known.c, rtol=1e-9, atol=1e-9)
    at = np.concatenate([x, rng.uniform(x[0] - 0.5, x[-1] + 0.5, 30)])
    np.testing.assert_allclose(interpolated(x, y, at), known(at), rtol=1e-9, atol=1e-9)
