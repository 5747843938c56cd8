"""Loss factors of clampings at several loads: what repeats at a load is no scatter."""

import numpy as np
import pytest
from bladeroot.diagnosis.channel import damping_channel
from bladeroot.diagnosis.damping_model import DampingData
from bladeroot.diagnosis.families import baseline, smooth
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.mechanisms.mechanism import Records

FORCES = np.array([4e3, 6e3, 8e3, 10e3, 13e3, 17e3])


def measured(bump, seed):
    """Two modes in two clampings a load, which scatter by 2 %; ln of the loss rises at 10 kN."""
    rng = np.random.default_rng(seed)
    mode, hold = np.tile([0, 1], 12), np.repeat(np.arange(12), 2)
    force, zero = np.tile(FORCES, 2)[hold], np.zeros(24)
    loss = np.log([4e-3, 7e-3])[mode] + 0.02 * rng.standard_normal(12)[hold]
    loss += bump * (force == 10e3) + 0.005 * rng.standard_normal(24)
    records = Records(mode=mode, force=force, sign=zero, time=zero, since=zero, span=0.0,
                      hold_span=0.0, temperature=None)  # fmt: skip
    stick = StickData(
        ("1B", "2B"), records, zero, np.full(24, 1e-5), hold, 0.0, np.arange(24), False, False
    )
    return damping_channel(DampingData(stick, loss, np.full(24, 1e-3)), ())


@pytest.mark.parametrize("seed", range(3))
def test_a_loss_that_is_higher_at_one_load_in_every_clamping_is_no_scatter(seed):
    gains = [
        smooth(made, baseline(made))["force"] for made in (measured(b, seed) for b in (0, 0.7))
    ]
    assert gains[0] < 0.0
    assert gains[1] > 8.0
