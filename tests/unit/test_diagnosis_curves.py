"""Errors of the curves: wide where repeats differ, loose where no record has a plateau."""

import numpy as np
import pytest
from bladeroot.diagnosis.curve_model import LOOSE, OFFSET, curve_data, problem
from bladeroot.diagnosis.dataset import level_offsets
from diagnosis_bench import FORCES, NOISE, campaign
from stiffness_beam import _model


def test_repeats_that_differ_make_the_mean_uncertain():
    """One of the records of a level is off in its first tenths of ln A, as beside another mode."""
    seen = campaign(_model(False), seed=1)
    level = (seen["mode"].values == "1B") & (seen["force"].values == FORCES[0])
    first = np.flatnonzero(level)[0]
    known = np.flatnonzero(np.isfinite(seen["frequency"].values[first]))
    off = seen.copy(deep=True)
    off["frequency"][first, known[-5:]] *= 1.0 + 200.0 * NOISE
    plain, wide = curve_data(seen, ("1B", "2B")), curve_data(off, ("1B", "2B"))
    ratio = np.sqrt(np.diag(wide.noise) / np.diag(plain.noise))
    n = plain.points.mode.size
    touched = np.flatnonzero((plain.level == 0) & (ratio[:n] > 1.5))
    amplitude = plain.points.amplitude
    assert touched.size
    assert np.all(amplitude[touched] >= 0.5 * seen["amplitude"].values[known[-5]])
    assert ratio[n:] == pytest.approx(1.0)
    count = plain.records[touched]
    stated = np.sqrt(np.diag(wide.noise))[touched]
    assert np.all(stated > 0.3 * 200.0 * NOISE / count)


def test_levels_without_a_plateau_begin_anywhere():
    seen = campaign(_model(False), seed=1)
    level = (seen["mode"].values == "1B") & (seen["force"].values == FORCES[0])
    seen["stick_frequency"][level] = np.nan
    data = curve_data(seen, ("1B", "2B"))
    assert not data.stuck[data.level == 0].any()
    assert data.stuck[data.level > 0].all()
    made = problem(data)
    whole = made.covariance(made.predict(np.zeros(0)), made.scales.mean)[0]
    first, other = (np.flatnonzero(data.level == k)[[0, -1]] for k in (0, 1))
    shared = [whole[a, b] - data.noise[a, b] for a, b in (first, other)]
    assert shared == pytest.approx([LOOSE**2, OFFSET**2])


def test_levels_are_drawn_from_where_their_small_amplitudes_lie():
    """A level's zero is arbitrary where no record has a plateau; a figure must not show it."""
    data = curve_data(campaign(_model(False), seed=1), ("1B", "2B"))
    shift = 1e-3 * (1 + np.concatenate([data.level, -data.level]))
    flat = level_offsets(data, shift)
    assert flat == pytest.approx(shift)
    bent = np.where(data.twice.amplitude > np.median(data.points.amplitude), shift + 1.0, shift)
    assert np.all(level_offsets(data, bent) < 0.5)
