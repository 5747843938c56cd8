"""The model of stick frequencies: slopes, causes that act on each other, changed matrices."""

from dataclasses import replace

import numpy as np
import pytest
from bladeroot.diagnosis.channel import stick_channel
from bladeroot.diagnosis.clampings import directions
from bladeroot.diagnosis.stick_model import kinked, near, problem, stick_data, trust_kernel
from bladeroot.diagnosis.structures import solved_change
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.rom.changed import changed_frequencies
from bladeroot.rom.parametric import ln_frequencies
from bladeroot.rom.parametric_build import parametric_model
from diagnosis_bench import MODES, campaign, programme, simulated
from stiffness_beam import beam_joint
from turning import by_differences

BY_ID = {one.id: one for one in catalogue()}
BASE = 3 + 2 * len(MODES) + 1


@pytest.fixture(scope="module")
def parts():
    model = parametric_model(beam_joint(), stiffness=(1e8, 1e11), tolerance=1e-6)
    seen = campaign(model, rows=programme(cycles=1), curves=False)
    return stick_data(seen, MODES), simulated(seen, model), seen


def point(mechanisms, *values):
    """Coordinates of a fit: kn and kt of the campaign, then the mechanisms' own."""
    own = [
        np.log(v) if p.log else v
        for one, some in zip(mechanisms, values, strict=True)
        for p, v in zip(one.parameters, some, strict=True)
    ]
    return np.concatenate([np.log([1.2e9, 1.8e9]), [0.02], np.zeros(BASE - 3), own])


@pytest.mark.parametrize(
    ("ids", "values"),
    [
        (("incomplete-contact",), [(4e3, 1.0)]),
        (("force-relaxation", "incomplete-contact"), [(0.02, 60.0), (4e3, 1.0)]),
        (("load-dependent-stiffness", "force-gain"), [(0.4, 0.1), (0.1,)]),
        (("force-offset", "loading-hysteresis"), [(800.0,), (0.2,)]),
    ],
)
def test_slopes_are_derivatives(parts, ids, values):
    mechanisms = [BY_ID[name] for name in ids]
    predict = problem(*parts[:2], mechanisms).predict
    theta = point(mechanisms, *values)
    slope = predict(theta).slope
    for k, h in enumerate(1e-5 * np.maximum(1.0, np.abs(theta))):
        step = h * np.eye(theta.size)[k]
        numeric = (predict(theta + step).mean - predict(theta - step).mean) / (2.0 * h)
        np.testing.assert_allclose(slope[:, k], numeric, atol=2e-4 * np.abs(numeric).max())


@pytest.mark.parametrize(
    ("ids", "values"),
    [
        (("incomplete-contact", "drift"), [(4e3, 1.0), (1e-3, 1e-3)]),
        (("load-dependent-stiffness", "loading-hysteresis"), [(0.4, 0.1), (0.2,)]),
        (("force-gain",), [(0.1,)]),
    ],
)
def test_the_turn_of_the_covariance_is_by_differences(parts, ids, values):
    mechanisms = [BY_ID[name] for name in ids]
    values = [some[: len(one.parameters)] for one, some in zip(mechanisms, values, strict=True)]
    made, theta = problem(*parts[:2], mechanisms), point(mechanisms, *values)
    chance, scales, n = np.random.default_rng(6), made.scales.mean, parts[0].ln_f.size
    vector, matrix = chance.normal(size=n), chance.normal(size=(n, n))
    matrix = matrix + matrix.T
    times, traces = made.predict(theta).turns(scales, vector, matrix)
    size = np.abs(made.covariance(made.predict(theta), scales)[0]).max()
    steps = 1e-4 * made.prior.std
    for k, change in enumerate(by_differences(made, theta, scales, steps)):
        near = 5e-3 * np.abs(change).max() + 1e-6 * size / made.prior.std[k]
        assert times[:, k] == pytest.approx(change @ vector, abs=near * np.sqrt(n))
        assert traces[k] == pytest.approx((change * matrix).sum(), abs=near * n)


def test_a_start_of_a_law_leaves_the_contact_as_it_was_on_average(parts):
    data, simulated, _ = parts
    channel = stick_channel(data, simulated, catalogue())
    law = BY_ID["incomplete-contact"]
    theta = point([law], (60e3, 1.0))
    shift = channel.undone(law, theta[BASE:])
    share = np.log(-np.expm1(-data.records.force / 60e3))
    assert shift[:2] == pytest.approx([-share.mean()] * 2)
    assert not shift[2:].any()
    assert not channel.undone(BY_ID["added-mass"], BY_ID["added-mass"].start).any()
    before = problem(data, simulated).predict(theta[:BASE]).mean
    far, near = (
        problem(data, simulated, [law]).predict(theta + np.append(move, [0.0, 0.0])).mean - before
        for move in (0.0 * shift, shift)
    )
    assert np.abs(near).max() < 0.5 * np.abs(far).max()


def test_a_law_of_the_force_goes_by_the_force_that_there_is(parts):
    data, simulated, _ = parts
    both = [BY_ID["force-gain"], BY_ID["incomplete-contact"]]
    found = problem(data, simulated, both).predict(point(both, (0.2,), (4e3, 1.0))).mean
    true = 1.2 * data.records.force
    share = np.log(-np.expm1(-true / 4e3))
    x = 0.02 * np.log(data.records.force / 12e3)
    points = np.column_stack([np.log(1.2e9) + x + share, np.log(1.8e9) + x + share, true])
    wanted = ln_frequencies(simulated.surface, points)[0][np.arange(true.size), data.records.mode]
    np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_no_cause_leaves_a_record_without_a_force(parts):
    data, simulated, _ = parts
    both = [BY_ID["force-offset"], BY_ID["incomplete-contact"]]
    least = data.records.force.min()
    for offset, inside in ((-0.9 * least, True), (-1.1 * least, False)):
        state = problem(data, simulated, both).predict(point(both, (offset,), (4e3, 1.0)))
        assert state.inside == inside
        assert np.isfinite(state.mean).all()


def test_laws_of_the_number_of_clampings_err_by_it(parts):
    data = parts[0]
    records = data.records
    late = np.where(records.clamping > 0.5, 1e6, 0.0)  # a pause in the middle
    paused = replace(records, time=records.time + late, span=records.span + 1e6)
    np.testing.assert_array_equal(paused.clamping, records.clamping)
    of_number = [
        trust_kernel(replace(data, records=one), BY_ID["ageing"].over) for one in (records, paused)
    ]
    np.testing.assert_array_equal(*of_number)
    assert BY_ID["drift"].of_form("step").over == BY_ID["ageing"].over


def test_a_hold_in_which_a_frequency_jumps_counts_as_two(parts):
    seen = parts[2]
    hold, mode = seen["hold"].values.astype(str), seen["mode"].values
    row = np.flatnonzero((hold == "h05") & (mode == "1B"))[-1]
    for size, wanted in ((2e-3, ("h05",)), (5e-6, ())):
        changed = seen.copy(deep=True)
        changed["stick_frequency"][row] *= 1.0 - size
        data = stick_data(changed, MODES)
        assert data.jumped == wanted
        of_hold = data.hold[np.flatnonzero(hold == "h05")]
        assert np.unique(of_hold).size == 1 + len(wanted)
        others = data.hold[hold != "h05"]
        np.testing.assert_array_equal(others, parts[0].hold[hold != "h05"])


def test_changed_matrices_move_frequencies_as_an_exact_solution_does(parts):
    data, simulated, _ = parts
    records, modulus = data.records, BY_ID["modulus-density"]
    by_record = 0.13 * np.log(records.force / 12e3)
    ln_kn, ln_kt = np.log(1.27e9) + by_record, np.log(1.91e9) + by_record
    places = np.column_stack([ln_kn, ln_kt, records.force])
    values = np.array([0.004, 0.0])
    found = solved_change(records, simulated.ritz, modulus, values, places)[0]
    for mode, ritz in enumerate(simulated.ritz):
        mine = records.mode == mode
        whole, _ = modulus.structure(ritz, values)
        f = [
            changed_frequencies(ritz, places[mine], [whole], np.full((mine.sum(), 1), amount))
            for amount in (0.0, 1.0)
        ]
        np.testing.assert_allclose(found[mine], np.log(f[1] / f[0]), rtol=2e-3)


def test_a_record_without_a_direction_has_that_of_its_hold():
    way = np.array(["up", "", "", "down", "", "up", "down", ""])
    hold = np.array(["a", "a", "b", "c", "c", "d", "d", "d"])
    assert directions(way, hold).tolist() == [1, 1, 0, -1, -1, 1, -1, 0]


def test_where_all_that_is_said_is_one_direction_the_rest_has_it():
    hold = np.array(["a", "b", "c"])
    assert directions(np.array(["up", "", "up"]), hold).tolist() == [1, 1, 1]
    assert directions(np.array(["", "", ""]), hold).tolist() == [0, 0, 0]


@pytest.mark.parametrize(("kernel", "grown"), [(kinked, 8.0), (near, 16.0)])
def test_errors_with_kinks_bend_more_over_short_distances(kernel, grown):
    """Of second differences the variance grows by the distance's cube, of smooth ones its fourth
    power.
    """

    def bent(step):
        return np.array([1.0, -2.0, 1.0]) @ kernel(step * np.arange(3.0), 0.8) @ [1.0, -2.0, 1.0]

    assert bent(0.02) / bent(0.01) == pytest.approx(grown, rel=0.03)
    assert np.linalg.eigvalsh(kernel(np.linspace(0.0, 3.0, 31), 0.8)).min() > -1e-12
