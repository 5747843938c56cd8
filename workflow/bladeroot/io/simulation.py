"""What a campaign is judged against: structures, a table of simulated frequencies, or nothing."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from bladeroot.io.load import Load
from bladeroot.schema import parse_yaml
from bladeroot.shipped_files import structure_file

# What a campaign's `simulation` may be besides a table's file name.
NONE, STRUCTURE, ASSEMBLY = "none", "structure", "assembly"
# Kinds of structure files that bring their own modes and bear any load; the others are dovetails.
OF_ASSEMBLIES = ("assembly", "lap-joint")
RESERVED = ("linear", "table")  # names of diagnoses without a structure


def simulation_of(description: Mapping, load: Load | None, folder: Path) -> dict:
    """`structure` as a list and `simulation` as "structure", "assembly", "none" or a table's file
    name.

    Raises:
        ValueError: both keys, a table that is not there, or a load that no structure can bear.
    """
    asked = description.get("simulation")
    named = description.get("structure")
    if asked is not None and named is not None:
        raise ValueError("structure and simulation say the same thing; one of them must go")
    asked = named if asked is None else asked
    if asked is None or asked == NONE:
        return {"structure": [], "simulation": NONE}
    if isinstance(asked, str) and asked.lower().endswith(".csv"):
        if not (folder / asked).is_file():
            raise ValueError(f"simulation: file not found: {asked}")
        return {"structure": [], "simulation": asked}
    names = [asked] if isinstance(asked, str) else list(asked)
    tables = [name for name in names if name.lower().endswith(".csv")]
    if tables:
        raise ValueError(f"a table is the only simulation or none, got {', '.join(names)}")
    reserved = [name for name in names if name in RESERVED]
    if reserved:
        raise ValueError(f"a structure must not be named {reserved[0]}: results/ uses the name")
    missing = [name for name in names if not structure_file(name, folder).is_file()]
    if missing:
        raise ValueError(
            f"simulation: neither a table (.csv) nor a structure's file: {missing[0]}.yaml is not "
            "beside campaign.yaml and none of the shipped ones"
        )
    if _are_assemblies(names, folder):
        return {"structure": names, "simulation": ASSEMBLY}
    if load is not None and not load.is_force:
        raise ValueError(
            f"a structure bears a force: the load's unit must be N or kN, got {load.unit!r} "
            f"({load.name})"
        )
    return {"structure": names, "simulation": STRUCTURE}


def _are_assemblies(names: Iterable[str], folder: Path) -> bool:
    """Whether structures are assemblies; ValueError if some are."""
    read = {name: parse_yaml(structure_file(name, folder)) for name in names}
    kinds = {name: isinstance(one, dict) and one.get("kind") in OF_ASSEMBLIES
             for name, one in read.items()}  # fmt: skip
    if any(kinds.values()) and not all(kinds.values()):
        other = next(name for name, one in kinds.items() if not one)
        raise ValueError(f"a dovetail cannot stand beside an assembly, got {other} beside others")
    return any(kinds.values())
