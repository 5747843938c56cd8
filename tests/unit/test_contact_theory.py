import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from bladeroot.contact.theory import normal_force, theory
from bladeroot.reproduction.published import published_stiffness

THESIS = Path(__file__).parents[2] / "resources" / "thesis"
FE_FORCES = np.arange(12e3, 23e3, 2e3)


def columns(name):
    with (THESIS / name).open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: [row[key] for row in rows] for key in rows[0]}


@pytest.fixture(scope="module")
def parameters():
    table = columns("../structures/flank.csv")
    return dict(zip(table["name"], map(float, table["value"]), strict=True))


@pytest.fixture(scope="module")
def published():
    table = columns("table_5_2.csv")
    return published_stiffness({key: list(map(float, cells)) for key, cells in table.items()})


def test_loads_of_the_two_friction_limits():
    """Both flanks of an end: N sin 45 each, and as much of T = 0.42 N."""
    axial, angle = np.sqrt(2) * 1e3 * np.array([1.0, 2.0]), np.pi / 4
    assert normal_force(axial, 0.0, angle) == pytest.approx([1e3, 2e3])
    assert normal_force(1.42 * axial, 0.42, angle) == pytest.approx([1e3, 2e3])


def test_published_totals_are_33_nodes(published):
    assert published["kn_total"].sel(force=12e3) == pytest.approx(33 * 41428.6e3)
    assert published["kt_total_std"].sel(force=22e3) == pytest.approx(33 * 19768.2e3)
    with pytest.raises(ValueError, match=r"missing column .*kt_N_per_mm"):
        published_stiffness({"force_kN": [1.0]})


def test_theory_at_twelve_kilonewton(parameters):
    """(pi/2) E* L / ln(2L/b) with b = 1.3183 mm from eq. 6.5 at N = 12 kN / sqrt 2."""
    result = theory(parameters, FE_FORCES)
    modulus = 210e9 / (2 * 0.91)
    expected = np.pi / 2 * modulus * 26e-3 / np.log(52 / 1.318287)
    at = result.sel(friction_state="T = 0", force=12e3)
    assert float(at["kn_theory"]) == pytest.approx(expected, rel=1e-6)
    printed = np.interp(12e3 / np.sqrt(2), result["normal_force"], result["kn_printed"])
    assert 0.002 < printed / expected - 1 < 0.01


def test_theory_compares_published_and_identified(parameters, published):
    identified = xr.Dataset(
        {
            name: (("structure", "force"), np.full((1, 2), value))
            for name, value in (("kn", 2e9), ("kt", 1e9), ("ln_kn_std", 0.1), ("ln_kt_std", 0.2))
        },
        coords={"structure": ["one"], "force": [12e3, 16e3]},
    )
    result = theory(parameters, FE_FORCES, identified, published)
    ratio = result["kn_identified_ratio"]
    assert ratio.dims == ("structure", "friction_state", "force")
    at = {"force": 16e3, "friction_state": "T = mu N"}
    back = ratio.sel(structure="one", **at) * result["kn_theory"].sel(at)
    assert float(back) == pytest.approx(2e9)
    assert np.isnan(ratio.sel(structure="one", force=14e3)).all()
    assert float(result["kt_published_ratio"].sel(at)) == pytest.approx(2.094, abs=1e-3)
    spread = result["kn_published_relative_std"].sel(force=12e3)
    assert float(spread) == pytest.approx(4866.6 / 41428.6)


def test_curves_agree_with_the_points_and_survive_netcdf(parameters, published, tmp_path):
    result = theory(parameters, FE_FORCES, None, published)
    curve = result["kt_of_axial_force"].interp(axial_force=FE_FORCES).values
    np.testing.assert_allclose(curve, result["kt_theory"].values, rtol=1e-6)
    for name, variable in result.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), name
    result.to_netcdf(tmp_path / "theory.nc")
    with xr.open_dataset(tmp_path / "theory.nc") as again:
        xr.testing.assert_identical(again.load(), result)


def test_sensitivities_follow_from_the_closed_form(parameters):
    """With w = ln(2L/b): E scales k, L enters k directly and through w, and b as -1/w."""
    result = theory(parameters, FE_FORCES)
    kn = result["kn_sensitivity"].to_series()

    def closed(**changes):
        return float(theory({**parameters, **changes}, FE_FORCES)["kn_theory"][0, 0])

    before = closed()
    for name in ("flat_half_width", "edge_radius", "length", "youngs_modulus"):
        ratio = closed(**{name: 1.01 * parameters[name]}) / before
        assert np.log(ratio) / np.log(1.01) == pytest.approx(kn[name], abs=2e-3), name
    assert 0 < kn["flat_half_width"] < 0.4
    assert 0 < kn["edge_radius"] < kn["flat_half_width"]
    assert 0.6 < kn["length"] < 1.0


def test_forces_that_press_nothing_are_refused(parameters):
    with pytest.raises(ValueError, match="must be positive"):
        theory(parameters, np.array([0.0, 1e3]))
