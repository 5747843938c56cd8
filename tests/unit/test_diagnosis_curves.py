"""Errors of the curves: wide where repeats differ, loose where no record has a plateau."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.diagnosis.channel import curve_channel
from bladeroot.diagnosis.curve_model import (
    OFFSET,
    OFFSET_NO_PLATEAU,
    curve_data,
    problem,
    strain,
    stretched,
)
from bladeroot.diagnosis.dataset import level_offsets
from bladeroot.diagnosis.families import Known, baseline, smooth
from bladeroot.diagnosis.naming import search
from bladeroot.inference.gaussian import fit
from bladeroot.mechanisms.catalogue import catalogue
from diagnosis_bench import FORCES, NOISE, campaign
from stiffness_beam import _model
from turning import by_differences


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
    assert shared == pytest.approx([OFFSET_NO_PLATEAU**2, OFFSET**2])


def test_levels_are_drawn_from_where_their_small_amplitudes_lie():
    """A level's zero is arbitrary where no record has a plateau; a figure must not show it."""
    data = curve_data(campaign(_model(False), seed=1), ("1B", "2B"))
    shift = 1e-3 * (1 + np.concatenate([data.level, -data.level]))
    flat = level_offsets(data, shift)
    assert flat == pytest.approx(shift)
    bent = np.where(data.twice.amplitude > np.median(data.points.amplitude), shift + 1.0, shift)
    assert np.all(level_offsets(data, bent) < 0.5)


def test_a_wild_first_point_is_not_the_zero_of_a_level_without_a_plateau():
    seen = campaign(_model(False), seed=1)
    level = np.flatnonzero((seen["mode"].values == "1B") & (seen["force"].values == FORCES[0]))
    seen["stick_loss_factor"][level] = np.nan
    first = np.isfinite(seen["loss_factor"].values[level]).argmax(axis=1)
    seen["loss_factor"][level, first] = 0.1
    seen["loss_factor_std"][level, first] = 0.1
    data = curve_data(seen, ("1B", "2B"))
    loss = data.value[data.value.size // 2 :][data.level == 0]
    assert np.median(np.abs(loss)) < 0.01


def test_the_covariance_turns_as_by_differences():
    data = curve_data(campaign(_model(False), seed=1), ("1B", "2B"))
    slip = next(one for one in catalogue() if one.id == "joint-slip")
    made = problem(data, [slip, next(o for o in catalogue() if o.id == "quadratic-drag")])
    at, scales = made.prior.mean, made.scales.mean
    chance = np.random.default_rng(5)
    vector, matrix = chance.normal(size=data.value.size), chance.normal(size=2 * data.value.shape)
    matrix = matrix + matrix.T
    times, traces = made.predict(at).turns(scales, vector, matrix)
    for k, turned in enumerate(by_differences(made, at, scales, np.full(at.size, 1e-4))):
        scale = np.abs(turned @ vector).max() + 1e-30
        assert times[:, k] == pytest.approx(turned @ vector, abs=1e-5 * scale)
        assert traces[k] == pytest.approx(np.sum(turned * matrix), rel=1e-4)


def test_fits_by_blocks_are_those_of_the_whole():
    """Of two modes and two quantities none shares an error with another."""
    data = curve_data(campaign(_model(False), seed=1), ("1B", "2B"))
    slip = next(one for one in catalogue() if one.id == "joint-slip")
    made = problem(data, [slip])
    assert len(made.blocks) == 4
    near = fit(made)
    parts, whole = (
        fit(one, near.parameters, near.scales)
        for one in (made, replace(made, blocks=(slice(0, None),)))
    )
    assert parts.log_evidence == pytest.approx(whole.log_evidence, abs=1e-6)
    assert parts.parameters == pytest.approx(whole.parameters, rel=1e-6)
    off = np.ones(parts.precision.shape, bool)
    for one in made.blocks:
        off[one, one] = False
    assert not made.covariance(parts.state, parts.scales)[0][off].any()


def test_what_begins_at_once_strains_the_errors_of_sharp_curves():
    """No smooth function follows it, which must not say that all is explained."""
    data = curve_data(campaign(_model(False), seed=1), ("1B", "2B"))
    late = data.twice.amplitude > np.median(data.points.amplitude)
    std = np.where(late, 1e-4, 3e-8)
    value = np.where(late, -3e-3, 0.0) + std * np.random.default_rng(0).normal(size=std.size)
    channel = curve_channel(replace(data, value=value, noise=np.diag(std**2)), [])
    found = search(channel, Known())
    assert smooth(channel, baseline(channel))["amplitude"] == strain(found.baseline) > 10.0
    assert found.unexplained == "amplitude"
    assert stretched(found.baseline) > 2.0
    plain = fit(problem(data))
    assert strain(plain) < 2.0
    assert stretched(plain) < 2.0
