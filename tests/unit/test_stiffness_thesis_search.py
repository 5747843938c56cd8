"""The thesis's search as a whole, on a small beam and on its own table."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.reproduction.thesis_search import FLANK_NODES, thesis_search
from bladeroot.rom.parametric import frequencies, surface_of
from bladeroot.rom.parametric_build import parametric_model
from bladeroot.stiffness.interpolation import ForceGauge, fe_forces
from stiffness_beam import beam_joint

FORCES = np.array([12e3, 16e3])
TRUE = np.array([1.4e9, 2.1e9])


@pytest.fixture(scope="module")
def found():
    model = parametric_model(beam_joint(equal_nodes=True), stiffness=(1e8, 1e11), tolerance=1e-6)
    points = np.column_stack([np.tile(np.log(TRUE), (2, 1)), FORCES])
    f = frequencies(surface_of(model), points)
    stick = xr.Dataset(
        {
            "mode": ("level", ["1B", "1B", "2B", "2B"]),
            "force": ("level", np.tile(FORCES, 2)),
            "frequency": ("level", f.T.ravel()),
            "frequency_std": ("level", np.full(4, 0.1)),
            "loss_factor": ("level", np.full(4, 0.005)),
            "loss_factor_std": ("level", np.full(4, 1e-4)),
        }
    )
    measured = fe_forces(stick, np.array([8e3, *FORCES]), ForceGauge(0.0, 0.0, "reading"))
    names = ("kn_total", "kt_total", "kn_nodal_std", "kt_nodal_std")
    table = xr.Dataset(
        {name: ("force", np.full(2, v)) for name, v in zip(names, (*TRUE, 1e6, 1e6), strict=True)},
        coords={"force": FORCES},
    )
    std = np.full((2, 2), 0.2)
    return model, thesis_search(model, measured, table, std, np.array([0.002, 0.002]))


def test_only_measured_forces_are_searched_and_the_truth_is_near_the_accepted(found):
    _, result = found
    np.testing.assert_array_equal(result["force"], FORCES)
    axis = result["grid_axis_kn"].values
    near = [int(np.abs(axis - k).argmin()) for k in TRUE]
    at = {"grid_axis_kn": near[0], "grid_axis_kt": near[1]}
    assert result["grid_accepted"].isel(at).all()
    assert result.attrs["springs"] == "equal at every node"


def test_chosen_frequency_is_the_grids_at_the_chosen_point(found):
    _, result = found
    here = result.sel(
        grid_axis_kn=result["grid_kn"], grid_axis_kt=result["grid_kt"], method="nearest"
    )
    np.testing.assert_allclose(
        here["grid_frequency"].transpose("force", "mode"), result["chosen_frequency"], rtol=1e-12
    )


def test_table_deltas_are_those_of_finite_differences(found):
    model, result = found
    surface, step = surface_of(model), 1e-5
    slopes = np.empty((2, 2))
    for i in range(2):
        k = np.tile(TRUE, (2, 1))
        k[:, i] *= [1 + step, 1 - step]
        f = frequencies(surface, np.column_stack([np.log(k), np.full(2, 12e3)]))
        slopes[:, i] = (f[0] - f[1]) / (2 * step * TRUE[i])
    covariance = np.linalg.inv(slopes.T @ slopes / 0.2**2)
    expected = np.sqrt(np.diag(covariance)) / FLANK_NODES
    np.testing.assert_allclose(result["table_std"].sel(table_force=12e3), expected, rtol=1e-5)
