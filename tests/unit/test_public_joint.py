"""Joints from matrices and the contact stiffness that frequencies ask for, against two masses."""

import bladeroot as br
import numpy as np
import pytest
from two_masses import GROUND, MASS, against, closed_form, two_masses


def test_frequencies_and_their_gradient_are_those_of_two_masses():
    K, M, pairs = two_masses()
    joint = br.Joint.from_matrices(K, M, pairs, {"n": against(0), "t": against(1)})
    ln_k = np.log([4e6, 9e5])
    found = joint.modes_at(ln_k)
    expected = [closed_form(4e6, 0), closed_form(9e5, 1)]
    np.testing.assert_allclose(found.frequency, expected, rtol=1e-9)
    step = 1e-5
    numeric = np.column_stack(
        [
            np.log(joint.modes_at(ln_k + d).frequency / joint.modes_at(ln_k - d).frequency)
            for d in step * np.eye(2)
        ]
    ) / (2.0 * step)
    np.testing.assert_allclose(joint.gradient(ln_k, found), numeric, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"ln_k": np.log([1e6])}, "ln_k must be ln of N/m for kn, kt, got"),
        ({"ln_k": np.array([1e6, 1e6])}, "ln_k must be ln of N/m for kn, kt, got"),
        ({"ln_k": np.array([np.nan, 1.0])}, "ln_k must be ln of N/m for kn, kt, got"),
        ({"names": ["z"]}, "modes must be among n, t, got \\['z'\\]"),
        ({"load": 12e3}, "a load of 12000 needs the joint's geometric stiffness Kg"),
    ],
)
def test_what_modes_cannot_be_asked_at_is_told(given, told):
    K, M, pairs = two_masses()
    joint = br.Joint.from_matrices(K, M, pairs, {"n": against(0), "t": against(1)})
    with pytest.raises(ValueError, match=told):
        joint.modes_at(**{"ln_k": np.log([1e6, 1e6])} | given)


def test_a_load_stiffens_by_its_own_matrix():
    K, M, pairs = two_masses()
    joint = br.Joint.from_matrices(K, M, pairs, {"n": against(0)}, Kg=np.diag([7.0] * 6))
    expected = np.sqrt((GROUND + 2.0 * 1e6 + 7.0 * 5e3) / MASS) / (2.0 * np.pi)
    found = joint.modes_at(np.log([1e6, 1e6]), load=5e3)
    assert found.frequency[0] == pytest.approx(expected, rel=1e-9)


def test_a_free_joint_has_no_rigid_motion_among_its_modes():
    _, M, pairs = two_masses()
    joint = br.Joint.from_matrices(np.zeros((6, 6)), M, pairs, {"n": against(0)})
    expected = np.sqrt(2.0 * 4e6 / MASS) / (2.0 * np.pi)
    assert joint.modes_at(np.log([4e6, 9e5])).frequency[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("load", [-1e-4, 1.0, 1e7])
def test_a_load_that_stiffens_a_rigid_motion_makes_no_elastic_mode(load):
    """Two free masses; the load holds their common motion along y alone."""
    _, M, pairs = two_masses()
    along = np.array([0.0, 1.0, 0.0, 0.0, 1.0, 0.0])
    joint = br.Joint.from_matrices(np.zeros((6, 6)), M, pairs, {"1": 1}, Kg=np.outer(along, along))
    expected = np.sqrt(2.0 * 9e5 / MASS) / (2.0 * np.pi)  # the lower of the elastic ones
    found = joint.modes_at(np.log([4e6, 9e5]), load=load).frequency
    assert found[0] == pytest.approx(expected, rel=1e-9)


def fit(frequencies, modes=(0, 1), **options):
    K, M, pairs = two_masses()
    names = dict(zip(frequencies, (against(axis) for axis in modes), strict=True))
    joint = br.Joint.from_matrices(K, M, pairs, names)
    return br.fit_contact(joint, frequencies, stiffness_range=(1e4, 1e8), **options)


def test_as_many_modes_as_stiffnesses_find_both():
    found = fit({"n": (closed_form(4e6, 0), 1e-3), "t": (closed_form(9e5, 1), 1e-3)}, fe_bias=1e-5)
    assert found.kn == pytest.approx(4e6, rel=1e-3)
    assert found.kt == pytest.approx(9e5, rel=1e-3)
    assert found.fits
    assert "kn" in repr(found)
    assert found.plot().axes


def test_roots_beyond_modes_that_change_places_are_found():
    """Modes by number: from the prior's mean the search meets where two of them cross."""
    joint = br.Joint.from_matrices(*two_masses(), {"d": 4, "e": 5, "f": 6})
    measured = joint.modes_at(np.log([4e6, 9e5])).frequency
    given = {name: (f, 0.05) for name, f in zip("def", measured, strict=True)}
    found = br.fit_contact(joint, given, fe_bias=1e-4)
    assert found.fits
    assert found.kn == pytest.approx(4e6, rel=1e-2)
    assert found.kt == pytest.approx(9e5, rel=1e-2)


def test_another_stiffness_of_the_same_frequencies_is_told():
    """Of two modes by number that change places, one takes the part of the other: two roots."""
    joint = br.Joint.from_matrices(*two_masses(), {"d": 4, "e": 5})
    truth = np.log([1e6, 9e5])
    measured = joint.modes_at(truth).frequency
    given = {name: (f, 1e-4) for name, f in zip("de", measured, strict=True)}
    found = br.fit_contact(joint, given, fe_bias=1e-6, stiffness_range=(1e4, 1e8))
    every = np.vstack([found.result["stiffness"], found.result["other_stiffness"]])
    assert len(every) > 1
    assert np.abs(np.log(every) - truth).max(axis=1).min() < 1e-3
    for k in every:
        np.testing.assert_allclose(joint.modes_at(np.log(k)).frequency, measured, rtol=1e-5)
    assert 0.0 < found.result["other_probability"].values.sum() < 1.0
    assert " or kn" in repr(found)


def test_where_modes_change_places_it_is_told():
    """Both of the measured modes are tangential, so that nothing is known of kn."""
    joint = br.Joint.from_matrices(*two_masses(), {"d": 4, "e": 5})
    measured = joint.modes_at(np.log([4e6, 9e5])).frequency
    given = {name: (f, 1e-4) for name, f in zip("de", measured, strict=True)}
    found = br.fit_contact(joint, given, fe_bias=1e-6, stiffness_range=(1e4, 1e8))
    assert found.kt == pytest.approx(9e5, rel=1e-3)
    assert found.result.attrs["crossed"] == "e"
    assert "another mode crosses e here" in repr(found)


def test_more_modes_than_stiffnesses_show_a_model_that_is_wrong():
    """The two tangential modes know one kt; with 1 % between them they contradict each other."""
    right = {
        "n": (closed_form(4e6, 0), 0.01),
        "y": (closed_form(9e5, 1), 0.01),
        "z": (closed_form(9e5, 2), 0.01),
    }
    assert fit(right, (0, 1, 2), fe_bias=1e-3).fits
    wrong = {**right, "z": (1.01 * right["z"][0], 0.01)}
    found = fit(wrong, (0, 1, 2), fe_bias=1e-3)
    assert not found.fits
    assert found.result.attrs["freedom"] == 1
    assert abs(float(found.result["misfit"].sel(mode="n"))) < 1.0


def test_fewer_modes_leave_the_prior_along_what_they_do_not_tell():
    found = fit({"n": (closed_form(4e6, 0), 1e-3)}, (0,), fe_bias=1e-5)
    assert found.kn == pytest.approx(4e6, rel=1e-3)
    wide = 0.25 * np.log(1e8 / 1e4)  # the prior's standard deviation
    assert float(found.result["ln_std"].sel(parameter="kt")) == pytest.approx(wide, rel=1e-3)


def test_each_interface_has_its_own_stiffness():
    K, M, _ = two_masses()
    pairs = br.ContactPairs(
        np.array([[0, 1, 2], [0, 1, 2]]),
        np.array([[3, 4, 5], [-1, -1, -1]]),
        np.array([[1.0, 0.0, 0.0]] * 2),
        np.ones(2),
        ("between", "wall"),
    )
    joint = br.Joint.from_matrices(K, M, pairs, {"1": 1, "2": 2})
    assert joint.parameters == ("kn between", "kt between", "kn wall", "kt wall")
    stiff = joint.modes_at(np.log([1e6, 1e6, 1e7, 1e6]), names=("1",)).frequency
    soft = joint.modes_at(np.log([1e6, 1e6, 1e5, 1e6]), names=("1",)).frequency
    assert stiff > soft


def uneven(modes):
    """The second mass held four times as stiffly: contact saturates the lower modes."""
    _, M, pairs = two_masses()
    return br.Joint.from_matrices(np.diag([1e6, 1.1e6, 1.2e6, 4e6, 4.4e6, 4.8e6]), M, pairs, modes)


@pytest.mark.parametrize("fe_bias", [1e-3, 1e-5])
def test_a_step_to_where_the_model_has_no_modes_is_shortened(fe_bias):
    joint = uneven({"1": 1, "2": 2, "3": 3})
    modes = joint.modes_at(np.log([2e6, 2e5]))
    measured = {name: (f, 1e-4) for name, f in zip(joint.modes, modes.frequency, strict=True)}
    found = br.fit_contact(joint, measured, fe_bias=fe_bias)
    np.testing.assert_allclose([found.kn, found.kt], [2e6, 2e5], rtol=1e-3)


def test_a_step_to_where_no_mode_has_the_shape_is_shortened():
    """As contact stiffens, one mass alone becomes both against each other, a MAC of a half."""
    ln_k = np.log([1e4, 2e4])
    shapes = uneven({name: n for n, name in enumerate("abcdef", 1)}).modes_at(ln_k).shape
    joint = uneven({"n": shapes[:, 3], "t": shapes[:, 4]})
    measured = {n: (f, 1e-4) for n, f in zip("nt", joint.modes_at(ln_k).frequency, strict=True)}
    found = br.fit_contact(joint, measured, fe_bias=1e-5, stiffness_range=(1e2, 1e10))
    np.testing.assert_allclose([found.kn, found.kt], np.exp(ln_k), rtol=1e-2)
    joint = uneven({"n": shapes[:, 3] + shapes[:, 4]})
    with pytest.raises(ValueError, match="no mode agrees with the shape of n"):
        br.fit_contact(joint, {"n": (225.0, 0.1)})


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"K": np.zeros((5, 6))}, "K must be square"),
        ({"M": None}, "M must be a matrix, got None"),
        pytest.param(
            {"pairs": None}, "ContactPairs, got a NoneType", marks=pytest.mark.wrong_shape
        ),
        ({"K": np.triu(np.ones((6, 6)))}, "K must be symmetric"),
        ({"M": np.eye(5)}, "expected M with 6 rows"),
        ({"Kg": np.full((6, 6), np.nan)}, "Kg must hold finite numbers"),
        ({"K": 2.0 * np.eye(6), "M": np.diag([3e6] * 6)}, "mass and stiffness exchanged"),
        ({"M": np.diag([2.0] * 5 + [-2.0])}, "M must have masses on its diagonal, got from -2 kg"),
        ({"modes": {}}, "at least one mode"),
        ({"modes": {"a": 0}}, "order from 1"),
        ({"modes": {"a": np.ones(3)}}, "6 finite numbers"),
    ],
)
def test_wrong_matrices_are_refused_in_one_line(change, told):
    K, M, pairs = two_masses()
    given = {"K": K, "M": M, "pairs": pairs, "modes": {"n": 1}} | change
    with pytest.raises(ValueError, match=told):
        br.Joint.from_matrices(**given)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"first": np.array([[0, 1, 9]])}, "rows from 0 to 5"),
        ({"normal": np.zeros((1, 3))}, "must not vanish"),
        ({"area": np.array([-1.0])}, "area must be positive"),
        ({"first": np.zeros((0, 3), int), "area": np.zeros(0)}, "at least one pair"),
        ({"interface": ("a", "b")}, "must name 1 interfaces"),
    ],
)
@pytest.mark.wrong_shape
def test_wrong_pairs_are_refused_in_one_line(change, told):
    K, M, pairs = two_masses()
    given = {name: getattr(pairs, name) for name in ("first", "second", "normal", "area")}
    with pytest.raises(ValueError, match=told):
        br.Joint.from_matrices(K, M, br.ContactPairs(**given | change), {"n": 1})


def test_a_shape_that_no_mode_has_is_told():
    K, M, pairs = two_masses()
    mixed = against(0) + against(1) + against(2)
    joint = br.Joint.from_matrices(K, M, pairs, {"n": mixed})
    with pytest.raises(ValueError, match="no mode agrees with the shape of n"):
        joint.modes_at(np.log([4e6, 9e5]))


@pytest.mark.parametrize("wrong", [10.0, (10.0,), ("10,0", 0.1)])
@pytest.mark.wrong_shape
def test_a_frequency_without_its_error_is_told(wrong):
    joint = br.Joint.from_matrices(*two_masses(), {"n": 1, "t": 2})
    for measured in ({"n": wrong, "t": wrong}, {"n": wrong, "t": (10.0, 0.1)}):
        with pytest.raises(ValueError, match=r"be \(frequency, standard error\) in Hz by mode"):
            br.fit_contact(joint, measured)
    with pytest.raises(ValueError, match="fe_bias must have a value for t, got"):
        br.fit_contact(joint, {"n": (10.0, 0.1), "t": (10.0, 0.1)}, fe_bias={"n": 0.01})


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"load": "12e3"}, "load must be a number, in the joint's unit of load, got '12e3'"),
        ({"load": [12e3, 13e3]}, "load must be a number"),
        ({"load": np.nan}, "load must be a number"),
        ({"frequencies": [("n", 10.0, 0.1)]}, "frequencies must be a mapping .* got a list"),
        ({"fe_bias": "small"}, "fe_bias must be a number, .* got 'small'"),
        ({"stiffness_range": 1e9}, "stiffness_range two numbers in N/m, .* 1000000000.0"),
    ],
)
@pytest.mark.wrong_shape
def test_an_argument_of_another_kind_is_told_by_its_name(change, told):
    joint = br.Joint.from_matrices(*two_masses(), {"n": 1, "t": 2})
    given = {"frequencies": {"n": (10.0, 0.1), "t": (12.0, 0.1)}} | change
    with pytest.raises(ValueError, match=told):
        br.fit_contact(joint, **given)
    if "load" in change:
        with pytest.raises(ValueError, match=told):
            joint.modes_at(np.log([1e6, 1e6]), change["load"])


@pytest.mark.wrong_shape
def test_modes_in_a_list_are_told():
    with pytest.raises(ValueError, match=r"modes must be a mapping .* got a list"):
        br.Joint.from_matrices(*two_masses(), ["n", "t"])


def test_an_unknown_mode_is_told():
    joint = br.Joint.from_matrices(*two_masses(), {"n": 1})
    with pytest.raises(ValueError, match="modes must be among n"):
        br.fit_contact(joint, {"m": (10.0, 0.1)})
