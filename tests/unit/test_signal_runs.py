"""What is done with samples row by row."""

import numpy as np
import pytest
from bladeroot.signal.runs import medians


@pytest.mark.parametrize("shape", [(7, 1), (3, 2), (5, 8), (4, 9)])
def test_medians_are_those_of_numpy(shape):
    rows = np.random.default_rng(0).standard_normal(shape)
    np.testing.assert_array_equal(medians(rows), np.median(rows, axis=1))
    np.testing.assert_array_equal(medians(np.round(rows)), np.median(np.round(rows), axis=1))
