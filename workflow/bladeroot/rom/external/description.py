"""The structure file of kind `matrices`: what it names, checked before anything is read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bladeroot.rom.external.matrix_file import check_file, split
from bladeroot.schema import read_yaml

# Metre, newton and kilogram of each system of units.
UNITS = {
    "m-N-kg": (1.0, 1.0, 1.0),
    "mm-N-t": (1.0e-3, 1.0, 1.0e3),
    "mm-kN-kg": (1.0e-3, 1.0e3, 1.0),
    "in-lbf-slinch": (0.0254, 4.4482216152605, 175.126835246477),
}
BODIES = ("beam", "Xn", "Xp")


@dataclass(frozen=True)
class Description:
    """A checked structure file: its content, its place, and the size of its units in SI."""

    path: Path
    data: dict[str, Any]
    length: float
    force: float
    mass: float

    @property
    def folder(self) -> Path:
        """Where the files lie that it names."""
        return self.path.parent

    @property
    def models(self) -> dict[str, dict[str, Any]]:
        """The given sets of matrices: those of an assembly's bodies; else `whole` alone, or `beam`
        and one or two of `Xn`, `Xp`.
        """
        if "bodies" in self.data:
            return self.data["bodies"]
        if "whole" in self.data:
            return {"whole": self.data["whole"]}
        return {"beam": self.data["beam"], **self.data["slots"]}

    def model_of(self, body: str) -> tuple[str, bool]:
        """The set of matrices that a body is part of, and whether it is its mirror image."""
        if "whole" in self.data:
            return "whole", False
        if body in self.models:
            return body, False
        return {"Xn": "Xp", "Xp": "Xn"}[body], True


def read_description(path: str | Path) -> Description:
    """Read and check the file and that all files exist that it names.

    Raises ValueError with a line a fault.
    """
    path = Path(path)
    data = read_yaml(path, "matrices")
    given = {"whole", "beam", "slots"} & set(data)
    if given not in ({"whole"}, {"beam", "slots"}):
        got = ", ".join(sorted(given)) or "neither"
        raise ValueError(f"expected beam and slots, or whole, got {got} ({path})")
    description = Description(path, data, *UNITS[data["units"]])
    faults = []
    for name, model in description.models.items():
        if name in ("beam", "whole"):
            check_loads(model, f"{path}, {name}")
        faults += missing(description, model)
    if faults:
        raise ValueError("\n".join(faults))
    return description


def matrices_of(model: dict[str, Any]) -> list[str]:
    """References to all matrices of one set."""
    names = [model[key] for key in ("mass", "stiffness", "geometric_stiffness") if key in model]
    return names + [one["stiffness"] for one in model.get("stiffness_at", [])]


def tables_of(description: Description) -> list[Path]:
    """All tables that it names: nodes, mappings, fixed nodes and contact pairs."""
    names = [
        model[key]
        for model in description.models.values()
        for key in ("nodes", "mapping", "fixed")
        if key in model
    ]
    return [
        description.folder / name for name in dict.fromkeys([*names, description.data["contact"]])
    ]


def matrix_files_of(description: Description) -> list[Path]:
    """All files of matrices that it names."""
    references = [one for model in description.models.values() for one in matrices_of(model)]
    names = dict.fromkeys(split(reference)[0] for reference in references)
    return [description.folder / name for name in names]


def check_loads(model: dict[str, Any], where: str, unloaded: bool = False) -> None:
    """Either a stiffness and its change per force, or stiffnesses at several forces.

    unloaded: whether a stiffness that no load changes will do.
    """
    given = {"stiffness", "geometric_stiffness", "stiffness_at"} & set(model)
    alone = {"stiffness"} if unloaded else {"stiffness_at"}
    if given not in ({"stiffness", "geometric_stiffness"}, {"stiffness_at"}, alone):
        raise ValueError(
            "expected stiffness and geometric_stiffness, or stiffness_at, got "
            f"{', '.join(sorted(given)) or 'neither'} ({where})"
        )
    forces = [one["force_N"] for one in model.get("stiffness_at", [])]
    if len(set(forces)) != len(forces):
        raise ValueError(f"stiffness_at: expected different forces, got {forces} ({where})")


def missing(description: Description, model: dict[str, Any]) -> list[str]:
    """A line for each file of matrices that is not there or cannot be read."""
    faults = []
    for reference in dict.fromkeys(split(one)[0] for one in matrices_of(model)):
        try:
            check_file(description.folder / reference)
        except ValueError as error:
            faults.append(f"{error} (named in {description.path})")
    return faults
