"""One campaign with one structure: what the simulation misses, why, and what the cause is worth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from bladeroot.diagnosis import curve_model, damping_model, stick_model
from bladeroot.diagnosis.channel import (
    curve_channel,
    damping_channel,
    not_judged,
    stick_channel,
)
from bladeroot.diagnosis.clampings import one_of_each_event
from bladeroot.diagnosis.curve_model import CurveData
from bladeroot.diagnosis.damping_model import DampingData
from bladeroot.diagnosis.families import Known
from bladeroot.diagnosis.guards import SIGMAS
from bladeroot.diagnosis.naming import Found, search
from bladeroot.diagnosis.records import Faulty, faulty_records, showing
from bladeroot.diagnosis.simulation.interface import Simulation
from bladeroot.diagnosis.stick_model import StickData
from bladeroot.diagnosis.sufficiency import curves_lacking, hopeless, lacking, replicated
from bladeroot.mechanisms.mechanism import Mechanism
from bladeroot.mechanisms.per_mode import of_modes
from bladeroot.terms import DOVETAIL, Terms

GAUGE_AND_LEVEL = ("force-gain", "force-offset")


@dataclass(frozen=True)
class Settings:
    """least_force: N, below which contact is not full and records are left out. splits: independent
    measurements (`naming.Known`). costs: hours of laboratory time that differ from `options.COSTS`.
    """

    least_force: float = 0.0
    splits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    costs: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Diagnosis:
    """All that was found; `verdict`, `dataset` and `extension` make artifacts of it.

    lacks: what the campaign lacks, a phrase each; curve_lacks: what its curves lack, which then
    name nothing. left_out: record mechanisms' consequence for the curves, a line, or "".
    not_judged: mechanisms that want what the campaign does not say of its records, and what is done
    without it, a line, or "". terms: the words in which all this is said.
    """

    seen: xr.Dataset
    settings: Settings
    known: Known
    data: StickData
    damping: DampingData | None
    curves: CurveData | None
    simulated: Simulation
    found: tuple[Found, ...]
    faulty: tuple[Faulty, ...]
    lacks: tuple[str, ...]
    curve_lacks: tuple[str, ...]
    left_out: str
    not_judged: str
    terms: Terms


def diagnose(
    seen: xr.Dataset,
    simulated: Simulation,
    settings: Settings,
    candidates: Sequence[Mechanism],
    terms: Terms = DOVETAIL,
) -> Diagnosis:
    """Judge a campaign.

    seen: from `bladeroot.diagnosis.observations`. simulated: any of
    `bladeroot.diagnosis.simulation`. candidates: from `bladeroot.mechanisms.catalogue`. terms: the
    campaign's own words.
    """
    seen = one_of_each_event(seen)
    modes = simulated.modes
    candidates = [of_modes(one, len(modes)) for one in candidates]
    data = stick_model.stick_data(seen, modes, settings.least_force)
    lacks = lacking(data, simulated.kind, simulated.knows_contact)
    barred = _barred(candidates, data, bool(lacks), settings.splits, simulated)
    known = Known(settings.splits, not lacks, barred, _ruled_out(settings))
    faulty = faulty_records(seen, candidates)
    skip, left_out = _spoiled(seen, faulty)
    curves = curve_model.curve_data(seen, modes, skip, simulated.slip)
    nothing = hopeless(data, simulated.kind)
    found = []
    if not nothing:
        found.append(search(stick_channel(data, simulated, candidates), known))
    damping = damping_model.damping_data(seen, data) if data.ln_f.size else None
    if damping is not None and not nothing:
        found.append(search(damping_channel(damping, candidates), known))
    curve_lacks = curves_lacking(curves)
    if curves is not None:
        of_contact = simulated.knows_contact and not nothing
        tied = _tied(candidates, found[0] if of_contact else None, len(modes))
        channel = curve_channel(curves, tied)
        why = f"the campaign lacks {' and '.join(curve_lacks)}"
        never = {one.id: why for one in channel.candidates} if curve_lacks else {}
        found.append(search(channel, Known(settings.splits, True, never)))
    return Diagnosis(
        seen, settings, known, data, damping, curves, simulated,
        tuple(found), tuple(faulty), tuple(lacks), tuple(curve_lacks), left_out,
        not_judged(candidates, data, simulated), terms,
    )  # fmt: skip


def with_lower_forces(
    seen: xr.Dataset,
    simulated: Simulation,
    settings: Settings,
    candidates: Sequence[Mechanism],
) -> Diagnosis | None:
    """The same with the records below the force of full contact; None where there are none."""
    below = seen["force"].values < settings.least_force
    if not (below & np.isfinite(seen["stick_frequency"].values)).any():
        return None
    return diagnose(seen, simulated, replace(settings, least_force=0.0), candidates)


def _barred(
    candidates: Sequence[Mechanism],
    data: StickData,
    few: bool,
    splits: Mapping[str, tuple],
    simulated: Simulation,
) -> dict[str, str]:
    """Mechanisms that the campaign, or the simulation, cannot speak of, and why."""
    barred = {}
    fixed = simulated.kind == "table" and not simulated.knows_contact
    for one in candidates:
        if one.measured_by in splits:
            continue
        if few and (one.kind == "level" or one.id in GAUGE_AND_LEVEL):
            barred[one.id] = "too few records to tell it from the scatter of clampings"
        elif fixed and one.id in GAUGE_AND_LEVEL:
            barred[one.id] = (
                "the table does not say how the contact's stiffness acts (by_ln_kn, by_ln_kt), and "
                "a wrong one looks alike"
            )
        elif one.kind == "direction" and not replicated(data):
            barred[one.id] = "no repeated clampings to tell it from their scatter"
    return barred


def _ruled_out(settings: Settings) -> dict[str, str]:
    """Mechanisms that the campaign says are not there, and how."""
    if settings.least_force > 0.0:
        return {"incomplete-contact": "the campaign says that contact is full at the {forces} used"}
    seated, std = settings.splits.get("pressure film", (np.inf, 0.0))
    if seated < SIGMAS * std:
        return {"incomplete-contact": "a pressure-sensitive film shows full contact at any load"}
    return {}


def _tied(candidates: Sequence[Mechanism], found: Found | None, modes: int) -> list[Mechanism]:
    """Candidates by each mode's part of energy in the contact springs, mean over the records.

    A frequency's derivative by ln k is half of k's part of the mode's potential energy, which for
    a stiff contact is as uncertain as k.
    """
    if found is None or "gradient" not in found.final.state.facts:
        return list(candidates)
    gradient, records = found.final.state.facts["gradient"], found.channel.records
    if not all((records.mode == m).any() for m in range(modes)):
        return list(candidates)
    parts = [2.0 * gradient[records.mode == m, :2].mean(axis=0) for m in range(modes)]
    energy = {
        name: [float(np.clip(part[k], 1e-4, 1.0)) for part in parts]
        for k, name in enumerate(("normal", "tangential"))
    }
    doubt = dict(zip(energy, found.final.std[:2].tolist(), strict=True))
    return [one.tied(energy, doubt) for one in candidates]


def _spoiled(seen: xr.Dataset, faulty: Sequence[Faulty]) -> tuple[np.ndarray, str]:
    """Records whose curves are not used, and a line on it."""
    skip = np.zeros(seen.sizes["record"], dtype=bool)
    names = []
    for one in faulty:
        spoiled = showing(seen, one.mechanism.spoils)
        if one.named and spoiled.any():
            skip |= spoiled
            names.append(one.mechanism.id)
    if not names:
        return skip, ""
    left = int((~skip).sum())
    text = f"curves of the {int(skip.sum())} records with {' and '.join(names)} are not used"
    return skip, f"{text}, {left} remain" if left else f"{text}: none remain"
