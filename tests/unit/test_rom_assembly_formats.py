"""The lap joint as CalculiX and Abaqus write it: the same frequencies, the same posterior."""

import numpy as np
import pytest
import scipy.sparse as sp
import yaml
from bladeroot.diagnosis.interfaces import interface_stiffness
from bladeroot.diagnosis.simulation.parametric import of_assembly
from bladeroot.diagnosis.stick_model import problem, stick_data
from bladeroot.inference.gaussian import best_fit
from bladeroot.rom.external.assembly import export_assembly
from bladeroot.rom.parametric import ln_frequencies, solved_of
from bladeroot.rom.whole import parametric_structure, reduced_structure
from lap_coarse import lap_assembly, lap_data, lap_model
from scipy.stats import norm
from test_diagnosis_interfaces import MODES, seen

LOAD = 1e4  # N, of the second stiffness


def triangle(matrix):
    """Rows, columns (from 0) and values of the upper triangle, as programs sort them."""
    one = sp.coo_array(sp.triu(matrix))
    order = np.lexsort([one.coords[1], one.coords[0]])
    parts = (part[order].tolist() for part in (*one.coords, one.data))
    return zip(*parts, strict=True)


def label(row):
    return row // 3 + 1, row % 3 + 1


def calculix(path, matrices):
    """*FREQUENCY, SOLVER=MATRIXSTORAGE: numbers of equations, thirteen digits."""
    for kind, matrix in matrices.items():
        end = "mas" if kind == "mass" else "sti"
        lines = [f"{i + 1} {j + 1} {v:20.13e}" for i, j, v in triangle(matrix)]
        path.with_name(f"{path.name}_{kind}.{end}").write_text("\n".join(lines) + "\n")
    rows = ["{}.{}".format(*label(row)) for row in range(matrices["mass"].shape[0])]
    path.with_name(f"{path.name}.dof").write_text("\n".join(rows) + "\n")
    return {"mapping": f"{path.name}.dof", "mass": f"{path.name}_mass.mas"}, "_{}.sti"


def abaqus(path, matrices):
    """*MATRIX GENERATE, FORMAT=MATRIX INPUT: nodes and directions."""
    for kind, matrix in matrices.items():
        lines = ["{}, {}, {}, {}, {:.15e}".format(*label(j), *label(i), v)
                 for i, j, v in triangle(matrix)]  # fmt: skip
        path.with_name(f"{path.name}_{kind}.mtx").write_text("\n".join(lines) + "\n")
    mass = f"{path.name}_mass.mtx"
    return {"mapping": mass, "mass": mass}, "_{}.mtx"


def structure_file(folder):
    """The assembly whose bodies two programs write, unloaded and loaded."""
    export_assembly(lap_assembly(), lap_data(), folder, "elsewhere")
    path = folder / "elsewhere.yaml"
    data = yaml.safe_load(path.read_text())
    for body, write in zip(lap_assembly().bodies, (calculix, abaqus), strict=True):
        loaded = body.stiffness + LOAD * body.geometric
        matrices = {"mass": body.mass, "unloaded": body.stiffness, "loaded": loaded}
        table = folder / data["bodies"][body.name]["nodes"]
        rows = [line.split(",") for line in table.read_text().splitlines()]
        table.write_text("\n".join(",".join(row[:4]) for row in rows) + "\n")
        named, form = write(folder / body.name, matrices)
        data["bodies"][body.name] = named | {
            "nodes": data["bodies"][body.name]["nodes"],
            "stiffness_at": [
                {"force_N": force, "stiffness": body.name + form.format(kind)}
                for force, kind in ((0, "unloaded"), (LOAD, "loaded"))
            ],
        }
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    return path


def posterior(model):
    """Intervals of the four stiffnesses from one campaign."""
    simulated, data = of_assembly(model, {}, {}, 0.005), stick_data(seen(), MODES)
    asked = problem(data, simulated)
    fitted = best_fit(asked, [asked.prior.mean])
    return interface_stiffness(data, simulated, [fitted], [], asked.prior.mean.size)


@pytest.mark.slow
def test_frequencies_and_posterior_are_the_built_in_ones(tmp_path):
    back = reduced_structure(structure_file(tmp_path))
    model = parametric_structure(back, {"force_kN": (0.0, 30.0)})
    points = np.random.default_rng(3).uniform(*lap_model()["box"].values, (20, 5))
    ours, theirs = (ln_frequencies(solved_of(one), points)[0] for one in (lap_model(), model))
    np.testing.assert_allclose(theirs, ours, atol=1e-4)
    one, other = (posterior(m) for m in (lap_model(), model))
    std = np.sqrt(np.diag(one["interface_ln_covariance"].values))[:, None]
    apart = np.log(other["interface_k"].values / one["interface_k"].values) / std
    # a quantile of n independent draws of a normal distribution has this standard deviation
    share = one["quantile"].values
    draws = min(found.attrs["interface_effective_draws"] for found in (one, other))
    of_one = np.sqrt(share * (1 - share) / draws) / norm.pdf(norm.ppf(share))
    assert (abs(apart) < 4 * np.sqrt(2) * of_one).all()
