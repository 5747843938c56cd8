"""What an artifact says of the load: its value is `force`, its name and unit are attributes.

The load is the axial force or whatever else a campaign varies; without one both are empty.
Artifacts that say nothing of it hold an axial force in newtons.
"""

from collections.abc import Mapping, Sequence

AXIAL_FORCE = "axial force"


def load_attrs(facts: Mapping) -> dict[str, str]:
    """Unit and name of a load's variable."""
    return {
        "units": facts.get("load_unit", "N"),
        "long_name": facts.get("load_name", AXIAL_FORCE) or "no load",
    }


def load_facts_of(records: Sequence) -> dict[str, str]:
    """What the first of some records' Datasets says of the load."""
    facts = next((one.attrs for one in records if "load_name" in one.attrs), {})
    return {name: str(facts[name]) for name in ("load_name", "load_unit") if name in facts}


def shown(facts: Mapping) -> tuple[float, str, str]:
    """Factor to the unit that a reader is shown, that unit, and the load's name.

    facts: attributes of an artifact. Those that say nothing of a load hold an axial force in N;
    name and unit are empty where there is no load.
    """
    name, unit = facts.get("load_name", AXIAL_FORCE), facts.get("load_unit", "N")
    return (1e-3, "kN", name) if unit == "N" else (1.0, unit, name)


def at_load(facts: Mapping) -> str:
    """` at 12 kN`, or nothing where there is no load; facts: of a record's artifact."""
    factor, unit, name = shown(facts)
    return f" at {factor * value_of(facts):g} {unit}" if name else ""


def value_of(facts: Mapping) -> float:
    """The load's value in the attributes of a record's artifact, 0 where there is none."""
    return float(facts["load"] if "load" in facts else facts.get("force_N", 0.0))
