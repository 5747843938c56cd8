"""Tables made from a known coarse geometry: it is found again, and a wrong table is named."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from bladeroot.reproduction.calibration import (
    Calibration,
    calibrate,
    linearise,
    posterior,
    predict,
)
from bladeroot.reproduction.calibration_result import calibration
from bladeroot.reproduction.parameters import parameters_of, values_in
from bladeroot.reproduction.targets import targets_of
from bladeroot.reproduction.tension import incompatible_sets, left_out
from structure_coarse import ROOT, coarse_data

TRUSTED = {"2.2": 0.2, "4.1": 0.2, "4.4": 0.2}
ENTRIES = [
    ("neck", 4.4, 0.4, {"beam.profile_mm.3.1": 1, "beam.profile_mm.4.1": 1}),
    ("shoulder", 11.0, 1.0, {"beam.profile_mm.2.1": 1}),
    ("modulus", 200.0, 4.0, {"material.young_modulus_GPa": 1}),
    ("pad", 7.0, 0.5, {"pad.thickness_mm": 1}),
]


@pytest.fixture(scope="module")
def problem():
    keys = ("name", "prior_mean", "prior_std", "moves")
    data = coarse_data()
    parameters = parameters_of([dict(zip(keys, one, strict=True)) for one in ENTRIES], data)
    tables = {path.stem: pd.read_csv(path) for path in ROOT.glob("resources/thesis/table_*.csv")}
    return Calibration(data, parameters, targets_of(tables, TRUSTED))


def with_tables_of(problem, truth, noise):
    """The problem with the tables that a known geometry gives, with errors of its tolerance."""
    values = predict(problem, truth) + np.linalg.cholesky(problem.covariance) @ noise
    return replace(
        problem,
        targets=[
            replace(one, reference=float(value))
            for one, value in zip(problem.targets, values, strict=True)
        ],
    )


@pytest.fixture(scope="module")
def known(problem):
    truth = problem.prior.mean + 0.7 * problem.prior.std * np.array([1.0, -1.0, 0.5, -1.0])
    noise = np.random.default_rng(5).standard_normal(len(problem.targets))
    return truth, with_tables_of(problem, truth, noise)


@pytest.fixture(scope="module")
def fitted(known):
    return calibrate(known[1], list(TRUSTED))


def test_a_known_geometry_is_found_within_its_deviations(known, fitted):
    truth, problem = known
    point = fitted.point
    mean, covariance = posterior(problem, fitted, np.ones(len(problem.targets), bool))
    std = np.sqrt(np.diag(covariance))
    assert np.all(np.abs(mean - point) < 0.05 * std)
    away = truth - point
    assert away @ np.linalg.solve(covariance, away) < 13.3  # 99 % of chi^2 with 4
    assert np.all(std < problem.prior.std)
    assert std[2] < 0.4 * problem.prior.std[2]


def test_derivatives_are_finite_differences(problem):
    point = values_in(problem.start, problem.parameters)
    jacobian = linearise(problem, point).jacobian
    step = 0.02 * problem.prior.std[0] * np.eye(len(point))[0]
    slope = (predict(problem, point + step) - predict(problem, point - step)) / (2 * step[0])
    np.testing.assert_allclose(jacobian[:, 0], slope, atol=2e-3 * np.abs(slope).max())


def test_tables_of_one_geometry_contradict_nothing(known, fitted):
    _, problem = known
    assert incompatible_sets(problem, fitted, 0) == []
    assert all(one.chance > 1e-3 for one in left_out(problem, fitted, list(TRUSTED)))


@pytest.mark.slow
def test_a_wrong_table_is_named(known):
    _, right = known
    wrong = [
        replace(one, reference=one.reference * (1.06 if one.table == "4.4" else 1.0))
        for one in right.targets
    ]
    problem = replace(right, targets=wrong)
    result = calibration(problem, ["2.2", "4.1"], refinements=0)
    z = dict(zip(result.table.values, np.abs(result.left_out_z.values), strict=True))
    assert z["4.4"] > 4
    assert max(z["2.2"], z["4.1"]) < 3
    assert result.sizes["set"] >= 1
    assert all("4.4" in tables for tables in result.set_tables.values)
    assert np.all(result.set_inflation > 1)
    assert np.all(result.direction_error.values < 1.0)
    assert result.target_fitted.values.sum() == 9
    assert np.all(result["std"].values > 0)
