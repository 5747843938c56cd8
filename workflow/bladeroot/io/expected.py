"""Where modes are expected: each at one frequency, or at some over the load, straight between."""

from collections.abc import Mapping

import numpy as np

from bladeroot.io.load import Load


def expected_at(mode: Mapping, load: Load | None, value: float | None) -> float:
    """Hz at a value of the load (SI); without one the middle of what is expected.

    mode: of the modes in campaign.yaml.
    """
    said = mode["expected_Hz"]
    if not isinstance(said, list):
        return float(said)
    loads, frequencies = np.array(said, float).T
    if load is None or value is None:
        return float(np.sqrt(frequencies.min() * frequencies.max()))
    return float(np.interp(value, load.given * loads, frequencies))


def faults_of_expected(modes: Mapping[str, Mapping], load: Load | None) -> list[str]:
    """What is wrong with frequencies over the load, and modes that are expected at one frequency:
    one peak would be taken for two modes.
    """
    faults, first = [], {}
    for name, mode in modes.items():
        said = mode["expected_Hz"]
        if isinstance(said, list):
            if load is None:
                faults.append(f"modes.{name}.expected_Hz over a load needs a load")
            elif not np.all(np.diff([at for at, _ in said]) > 0.0):
                faults.append(f"modes.{name}.expected_Hz: expected loads in rising order")
        other = first.setdefault(str(np.array(said, float)), name)
        if other != name:
            faults.append(f"modes: {other} and {name} have the same expected_Hz, {said}")
    return faults
