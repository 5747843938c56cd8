"""Settings of a simulated curve that go with no curve are told before the run."""

from pathlib import Path

import pytest
import yaml
from bladeroot.nonlinear.settings import check_nonlinear

SHIPPED = yaml.safe_load(
    (Path(__file__).resolve().parents[2] / "config" / "config.yaml").read_text()
)["nonlinear"]


def test_what_is_shipped_goes_together():
    check_nonlinear(SHIPPED)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"harmonics": [3, 1]}, r"harmonics must ascend, got \[3, 1\]"),
        ({"amplitude_um": [100, 1]}, "amplitude_um must rise, got 100 to 1"),
        ({"law": "coulomb", "method": "quasi-static"}, "method must be harmonic-balance"),
        ({"law": "coulomb", "method": "fixed-shape"}, "got fixed-shape"),
    ],
)
def test_what_goes_with_no_curve_is_refused(change, told):
    with pytest.raises(ValueError, match=told):
        check_nonlinear(SHIPPED | change)
