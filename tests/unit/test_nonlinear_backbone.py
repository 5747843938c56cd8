"""The artifact of curves: shape, units, and an answer where there is no curve."""

import numpy as np
import pytest
from bladeroot.nonlinear.backbone import amplitude_ladder, backbone
from bladeroot.nonlinear.flanks import FlankContact
from nonlinear_systems import coarse_joint

POINTS = np.array([[np.log(2e9), np.log(2e9), force] for force in (6e3, 12e3)])


def test_curves_of_every_mode_and_force_with_units():
    amplitudes = amplitude_ladder(1.0, 10.0, 4)
    found = backbone(
        coarse_joint(), POINTS, {"1B": 0.0, "2B": -0.07}, FlankContact(pressure=2.0, strips=4),
        amplitudes, "quasi-static", loss=1e-3,
    )  # fmt: skip
    assert found["frequency"].shape == (2, 2, 5)
    assert found["complete"].values.all()
    assert (found["loss_factor"].values > 0.999e-3).all()
    assert (np.diff(found["frequency"], axis=2) <= 1e-9).all()
    assert (found["first_slip"].diff("force") > 0.0).all()
    assert all("units" in found[name].attrs for name in found.data_vars)


def test_a_mode_that_is_not_there_is_an_answer():
    found = backbone(
        coarse_joint(), POINTS[:1], {"9T": 0.0}, FlankContact(), amplitude_ladder(1.0, 2.0, 4)
    )
    assert not found["complete"].values.any()
    assert "no mode 9T" in str(found["reason"].values[0, 0])
    assert np.isnan(found["frequency"]).all()


def test_ladder_must_rise():
    with pytest.raises(ValueError, match="amplitudes must rise"):
        amplitude_ladder(1.0, 1.0, 10)


WRONG = [
    ({"law": "glue"}, "contact law"),
    ({"preload": "odd"}, "preload"),
    ({"pressure": "punch"}, "with its punch"),
]


@pytest.mark.parametrize(("change", "text"), WRONG)
def test_contact_refuses_what_it_does_not_know(change, text):
    with pytest.raises(ValueError, match=text):
        FlankContact(**change)
