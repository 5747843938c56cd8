"""What causes gain on parts that were left out of what they act on, and on a load never seen."""

import numpy as np
import pytest
from bladeroot.diagnosis import stick_model
from bladeroot.diagnosis.diagnose import Settings, diagnose
from bladeroot.diagnosis.gain import gains
from bladeroot.diagnosis.next_measurement import _joined, _predicted
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.mechanisms.mechanism import Records
from diagnosis_bench import MODES, campaign, programme, simulated
from numpy import ndarray
from stiffness_beam import _model

EFFECTS = {
    "exponent": ("load-dependent-stiffness", 0.5, "between_forces"),
    "drift": ("drift", 6e-3, "between_times"),
    "hysteresis": ("loading-hysteresis", 0.5, "between_directions"),
    "relaxation": ("force-relaxation", 0.06, "between_times_in_a_hold"),
    "slip": ("joint-slip", 2e-3, "between_amplitudes"),
}


def diagnosed(effect: str, seen=None):
    name, size, _ = EFFECTS[effect]
    if seen is None:
        seen = campaign(_model(False), effect, size, curves=effect == "slip", scatter=0.02)
    wanted = [one for one in catalogue() if one.id == name]
    return diagnose(seen, simulated(seen, _model(False)), Settings(), wanted)


@pytest.mark.slow
@pytest.mark.parametrize("effect", EFFECTS)
def test_errors_fall_where_what_the_cause_acts_on_is_left_out(effect):
    name, _, key = EFFECTS[effect]
    made = diagnosed(effect)
    assert [c.mechanism.id for found in made.found for c in found.causes] == [name]
    sides = gains(made)[key]
    for one in sides.values() if effect == "slip" else [sides]:
        assert one["after"] < 0.8 * one["before"], one


def test_a_fresh_clamping_at_an_unseen_load_is_met():
    """Fitted to the loads below the largest, whose clampings are then predicted."""
    size = EFFECTS["exponent"][1]
    seen = campaign(_model(False), "exponent", size, rows=programme(3, 1), curves=False)
    whole = stick_model.stick_data(seen, MODES)
    top = whole.records.force == whole.records.force.max()
    made = diagnosed("exponent", seen.isel(record=np.flatnonzero(~top)))
    fresh = Records(
        **{
            name: part[top] if isinstance(part, ndarray) else part
            for name, part in vars(whole.records).items()
        }
    )
    data = _joined(made.data, fresh, whole.hold[top] + 100)
    (found,) = (one for one in made.found if one.channel.name == "stick")
    old, new = np.arange(made.data.ln_f.size), np.arange(made.data.ln_f.size, data.ln_f.size)
    misses = []
    for causes, fitted in (((), found.baseline), ([found.causes[0].mechanism], found.final)):
        problem = stick_model.problem(data, made.simulated, causes)
        mean, covariance = _predicted(problem, fitted, old, new)
        misses.append(whole.ln_f[top] - mean)
    of_hold = np.sqrt(np.mean((misses[1] / np.sqrt(np.diag(covariance))) ** 2))
    assert of_hold < 2.0
    assert np.abs(misses[1].mean()) < 0.5 * np.abs(misses[0].mean())
