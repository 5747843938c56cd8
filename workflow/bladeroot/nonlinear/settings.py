"""Settings of a simulated curve that must fit together; the schema checks each by itself."""

from collections.abc import Mapping


def check_nonlinear(settings: Mapping) -> None:
    """Raise ValueError, in one line, if settings of section `nonlinear` do not fit together."""
    harmonics, (low, high) = settings["harmonics"], settings["amplitude_um"]
    if list(harmonics) != sorted(harmonics):
        raise ValueError(f"nonlinear.harmonics must ascend, got {list(harmonics)}")
    if not low < high:
        raise ValueError(f"nonlinear.amplitude_um must rise, got {low:g} to {high:g}")
    if settings["law"] == "coulomb" and settings["method"] != "harmonic-balance":
        raise ValueError(
            "nonlinear.method must be harmonic-balance with law coulomb, whose normal load varies, "
            f"got {settings['method']}"
        )
