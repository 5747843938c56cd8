"""Numbers of a structure file as parameters, and structures with other values of them."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.fem.geometry import Structure, structure_from_mapping

# Ending of a key of the structure file -> SI unit and the size of the file's unit in it.
_UNITS = {"_mm": ("m", 1e-3), "_GPa": ("Pa", 1e9), "_kg_m3": ("kg/m3", 1.0)}


@dataclass(frozen=True)
class Parameter:
    """A combination of a structure file's numbers (`measures`), and what moves when it grows.

    Both map paths such as "beam.profile_mm.3.1" to shares. The prior is Gaussian, in the unit of
    the file's key.
    """

    name: str
    prior_mean: float
    prior_std: float
    moves: Mapping[str, float]
    measures: Mapping[str, float]

    @property
    def unit(self) -> tuple[str, float]:
        """SI unit and the size of the file's unit in it."""
        keys = next(iter(self.moves)).split(".")
        return next(unit for end, unit in _UNITS.items() if any(key.endswith(end) for key in keys))


def parameters_of(
    entries: Sequence[Mapping[str, Any]], start: Mapping[str, Any]
) -> list[Parameter]:
    """Parameters of a calibration file, checked against the structure file's content `start`.

    ValueError if a path leads to no number, or if a parameter is moved by another or not by itself:
    its value would then not be its own.
    """
    found = []
    for one in entries:
        first = next(iter(one["moves"]))
        measures = one.get("measures", {first: 1.0})
        for path in (*one["moves"], *measures):
            number = _look_up(start, path)
            if isinstance(number, bool) or not isinstance(number, int | float):
                raise ValueError(f"{one['name']}: expected a number at {path}, got {number!r}")
            if not any(key.endswith(tuple(_UNITS)) for key in path.split(".")):
                raise ValueError(f"{one['name']}: {path} is no length, modulus or density")
        moves, measures = (
            {path: float(share) for path, share in shares.items()}
            for shares in (one["moves"], measures)
        )
        prior = float(one["prior_mean"]), float(one["prior_std"])
        found.append(Parameter(one["name"], *prior, moves, measures))
    for one in found:
        for other in found:
            moved = sum(share * other.moves.get(path, 0.0) for path, share in one.measures.items())
            if abs(moved - (one is other)) > 1e-9:
                raise ValueError(
                    f"{other.name} moves {one.name} by {moved:g} of its own change, "
                    f"expected {int(one is other)}"
                )
    return found


def values_in(data: Mapping[str, Any], parameters: Sequence[Parameter]) -> Float[ndarray, " p"]:
    """The parameters' values in a structure file's content, in its units."""
    return np.array(
        [
            sum(share * _look_up(data, path) for path, share in one.measures.items())
            for one in parameters
        ]
    )


def with_values(
    data: Mapping[str, Any], parameters: Sequence[Parameter], values: Float[ndarray, " p"]
) -> Structure:
    """The structure with these parameters; ValueError if its shape cannot be."""
    changed = copy.deepcopy(data)
    for one, change in zip(parameters, values - values_in(data, parameters), strict=True):
        for path, share in one.moves.items():
            *way, last = path.split(".")
            place = _look_up(changed, ".".join(way))
            key = int(last) if isinstance(place, list) else last
            place[key] = float(place[key] + share * change)
    return structure_from_mapping(changed, data["name"])


def _look_up(data: Any, path: str) -> Any:
    for step in path.split("."):
        try:
            data = data[int(step)] if isinstance(data, list) else data[step]
        except (KeyError, IndexError, ValueError, TypeError):
            raise ValueError(f"the structure file has no {path}") from None
    return data
