"""Whether a campaign can tell causes apart at all, and what it lacks."""

import numpy as np

from bladeroot.diagnosis import guards
from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.stick_model import StickData

# Records of a linear mode from which it can be told from its scatter.
LINEAR_RECORDS = 4
# Begins the phrase of what bars gauge and level effects alone: laws of all else can be judged.
FEW = "records"


def lacking(data: StickData, kind: str = "structure", contact: bool = True) -> list[str]:
    """What the stick frequencies lack, a phrase each; empty where they suffice.

    kind: of the simulation; with none, level and slope over the load are free, and nothing is said
    that would need more than repeats. contact: whether it has kn and kt.
    """
    records = data.records
    if kind == "none" and not data.ln_f.size:
        return ["records that reach a stick plateau: no frequency at small amplitude is known"]
    if kind == "none":
        phrase = "repeated clampings: without them their scatter is not known"
        return [] if replicated(data) else [phrase]
    forces = np.unique(records.force)
    lacks = []
    if contact and np.unique(records.mode).size < guards.MODES:
        lacks.append("a second mode: one frequency cannot tell kn from kt")
    of_load = kind == "structure" or forces.size > 1
    if of_load and forces.size < guards.FORCES:
        lacks.append(f"more {{loads}}: {forces.size} where a law needs {guards.FORCES} or more")
    if not replicated(data):
        lacks.append(
            "repeated clampings: without several clampings at one {force} the scatter of clamping "
            "is known only from how the records miss a law"
        )
    if data.ln_f.size < guards.RECORDS:
        lacks.append(
            f"{FEW}: {data.ln_f.size} where some {guards.RECORDS} tell {{gauge}} and level effects "
            "from the scatter of clampings"
            if of_load
            else f"{FEW}: {data.ln_f.size} where some {guards.RECORDS} tell levels from scatter"
        )
    return lacks


def curves_lacking(curves: CurveData | None) -> list[str]:
    """What the curves lack for naming a cause, a phrase each; empty where they suffice."""
    if curves is None:
        return []
    lacks = []
    if np.unique(curves.points.mode).size < guards.MODES:
        lacks.append("curves of a second mode")
    if np.unique(curves.points.force).size < guards.CURVE_FORCES:
        lacks.append("curves at a second {load}")
    return lacks


def replicated(data: StickData) -> bool:
    """Whether at least half of the forces have repeated holds."""
    records = data.records
    per_mode = [
        np.unique(data.hold[(records.force == f) & (records.mode == m)]).size
        for f in np.unique(records.force)
        for m in np.unique(records.mode)
    ]
    return bool(per_mode) and bool(np.mean(np.array(per_mode) >= guards.HOLDS_A_FORCE) >= 0.5)


def hopeless(data: StickData, kind: str = "structure") -> bool:
    """Whether no law of the force can be judged: one mode, or too few forces; without a structure,
    too few records.
    """
    records = data.records
    if kind != "structure":
        return data.ln_f.size < LINEAR_RECORDS
    return (
        np.unique(records.mode).size < guards.MODES or np.unique(records.force).size < guards.FORCES
    )
