"""kn and kt with the causes that a model file names: one model of all records, fitted and sampled.

The causes are a part of the model, with their priors; of the file only their forms are taken, and
their sizes as a start: the sizes come from the same frequencies, which would count twice.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.diagnosis.clampings import one_of_each_event
from bladeroot.diagnosis.dataset import stiffness_law
from bladeroot.diagnosis.extension import Extension
from bladeroot.diagnosis.simulation.parametric import Parametric
from bladeroot.diagnosis.stick_model import StickData, problem, stick_data
from bladeroot.inference.gaussian import Fit, fit
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.stiffness.posterior import Law, posterior
from bladeroot.stiffness.priors import CORRELATION, PRIORS, SCATTER, SMOOTH_EXPONENT

_SCALES = {(False, False): "", (True, False): "ln ", (False, True): "logit "}  # of a parameter
DRAWS = 1000  # each asks for a covariance of all records


def extended_joint(
    seen: xr.Dataset,
    simulated: Parametric,
    extension: Extension,
    least_force: float,
    forces: Sequence[float],
    draws: int = DRAWS,
) -> xr.Dataset:
    """Posterior of (ln kn, ln kt) with the causes, beside the evidence without.

    seen: from `bladeroot.diagnosis.observations`. simulated: the structure's. least_force: N, below
    which records are left out. forces: N, where kn and kt are wanted. The variables are those of
    `bladeroot.stiffness.joint` without what would help and what was assumed; its levels are the
    records. Empty, with `law` "", without records of two modes.
    """
    seen = one_of_each_event(seen)
    data = stick_data(seen, simulated.modes, least_force)
    named = {"structure": simulated.structure, "least_force_N": least_force}
    if len(set(data.records.mode)) < 2:
        return xr.Dataset(attrs=named | {"law": ""})
    taken = [(one, values) for one, values in extension.causes if one.curve is None]
    taken = [(one, values) for one, values in taken if one.damping is None and not one.finding]
    causes = [one for one, _ in taken]
    ids = " and ".join(one.id for one in causes)
    law = f"smooth contact with {ids}" if causes else "smooth contact"
    without = fit(problem(data, simulated))
    laws = {"smooth contact": _law(data, without, [])}
    if causes:
        sizes = [
            p.coordinate(value)
            for one, values in taken
            for p, value in zip(one.parameters, values, strict=True)
        ]
        start = np.concatenate([without.parameters, sizes])
        laws[law] = _law(data, fit(problem(data, simulated, causes), start), causes)
    levels = {
        "mode": np.array(data.modes)[data.records.mode],
        "force": data.records.force,
        "ln_frequency": data.ln_f,
    }
    ends = (float(levels["force"].min()), float(levels["force"].max()))
    found = posterior(laws, law, forces, ends, levels, draws)
    # The joint inference counts a bias from the model, the diagnosis from the measurement.
    turned = found["parameter"].str.contains("^(?:bias|tilt)_")
    for name in ("prior_mean", "mode_value", "posterior_mean"):
        found[name] = found[name].where(~turned, -found[name]).assign_attrs(found[name].attrs)
    left = [one.id for one, _ in extension.causes if one not in causes]
    return found.assign_attrs(
        named,
        extended_by=";".join(one.id for one in causes),
        extension_left_out=";".join(left),
    )


def _law(data: StickData, found: Fit, causes: Sequence[Mechanism]) -> Law:
    """A fit of the records with the names of its parameters, and kn and kt over the true force."""
    biases = [f"{part}_{mode}" for part in ("bias", "tilt") for mode in data.modes]
    biases.append("tension")
    names = ["ln_kn", "ln_kt", "exponent", *biases]
    origins = [
        PRIORS["ln_kn"][2],
        PRIORS["ln_kt"][2],
        SMOOTH_EXPONENT[2],
        *["search.fe_bias_percent"] * len(biases),
    ]
    first = len(names)
    for one in causes:
        names += [f"{one.id} {_SCALES[p.log, p.bounded]}{p.name}" for p in one.parameters]
        origins += [p.source for p in one.parameters]

    def ln_k(theta: ndarray, force: ndarray) -> Float[ndarray, "draw force 2"]:
        laws = [stiffness_law(row, first, causes, force)[0].T for row in theta]
        return np.array(laws).reshape(len(theta), force.size, 2)

    scales = ["ln_scatter", "ln_scatter_kt", "atanh_correlation", "ln_noise", "ln_law_error"]
    origins += [SCATTER[2], SCATTER[2], CORRELATION[2], "records of one clamping", "laws' own"]
    return Law(found, ln_k, (*names, *scales), tuple(origins))
