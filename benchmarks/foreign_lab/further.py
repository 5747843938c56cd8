"""A further measurement that a verdict asks for, carried out on the same specimen."""

from dataclasses import fields, replace

import numpy as np

from foreign_lab.case import Case, disturb
from foreign_lab.sheet import Sheet

KEPT, STEPS = 3600.0, 6  # s that a clamping is kept, and records of each mode in it
HARDER = 2.0  # times the usual amplitude at release


def facts(case: Case, kind: str, rng: np.random.Generator) -> list[dict]:
    """What tests beside the campaign find (`independent` of campaign.yaml)."""
    hidden = {one.id: one.size for one in case.effects}
    sheet, found = case.sheet, []
    if "load cell" in kind:
        # Read as each load is reached, before it relaxes. A straight line's misfit is its error.
        fresh = replace(sheet, state=dict(sheet.begun))
        disturb(fresh, [one for one in case.effects if one.id != "force-relaxation"])
        there, read = fresh.state["force"], sheet.reading
        lag = -np.sign(sheet.direction) * read
        rows = np.stack([read, np.ones(len(read)), lag], axis=1)
        if not 0 < np.mean(sheet.direction > 0) < 1:
            rows = rows[:, :2]
        scale, zero, *rest = line = np.linalg.lstsq(rows, there, rcond=None)[0]
        misfit = np.sqrt(np.mean((there - rows @ line) ** 2))
        part = np.hypot(0.005, misfit / read.max())
        found.append(("load cell scale", scale - 1.0, part))
        found.append(("load cell zero", zero, np.hypot(50.0, misfit)))
        found += [("load cell hysteresis", value, part) for value in rest]
    if "weighing" in kind:
        found.append(("weighing", hidden.get("added-mass", 0.0), 1e-3))
    if "free-free" in kind:
        found.append(("free-free", hidden.get("modulus-density", 0.0), 2e-3))
    if "rig stiffness" in kind:
        soft = hidden.get("rig-compliance", 0.0)
        found.append(("rig stiffness", soft / (1.0 + soft), 0.01))
    if "pressure film" in kind:
        found.append(("pressure film", hidden.get("incomplete-contact", 0.0), 500.0))
    return [
        {"measurement": name, "value": float(value + std * rng.normal()), "std": std}
        for name, value, std in found
    ]


def with_records(
    case: Case, kind: str, load: float, clampings: int, rng: np.random.Generator
) -> Case:
    """The campaign with the further records behind its own.

    kind: `another load`, `both directions`, `kept clamping`, `larger amplitude` or `all again`.
    load: N.
    """
    sheet, bench = case.sheet, case.bench
    if kind == "all again":
        rows = [
            (sheet.mode[k], sheet.reading[k], sheet.direction[k], sheet.in_hold[k], sheet.hold[k])
            for k in range(len(sheet.mode))
        ]
    else:
        signs = [1, -1] * (clampings // 2) if kind == "both directions" else [1] * clampings
        since = np.linspace(0.0, KEPT, STEPS) if kind == "kept clamping" else [0.0]
        rows = [
            (mode, load, sign, 60.0 + s, number)
            for number, sign in enumerate(signs)
            for s in since
            for mode in ("1B", "2B")
        ]
    mode, reading, direction, in_hold, hold = (np.array(part) for part in zip(*rows, strict=True))
    newtons, count = 10.0 * bench.piston_cm2, len(mode)
    times = HARDER if kind == "larger amplitude" else 1.0
    started = {m: times * sheet.usual_start(m) for m in np.unique(sheet.mode)}
    apart = 1800.0 + (KEPT if kind == "kept clamping" else 0.0)
    begun = sheet.time.max() + apart * (1 + np.unique(hold, return_inverse=True)[1])
    reading = np.maximum(np.round(reading / newtons), 1.0) * newtons
    loads = sheet.planned("reading")
    new = {
        "mode": mode, "reading": reading, "direction": direction, "in_hold": in_hold,
        "hold": sheet.hold.max() + 1 + np.unique(hold, return_inverse=True)[1],
        "time": begun + in_hold, "group": np.zeros(count, int),
        "start": np.array([started[m] for m in mode]),
        "turning": np.where(direction > 0, loads.min(), loads.max()),
        "temperature": np.full(count, sheet.temperature[-1]),
    }  # fmt: skip
    new["clamped"] = new["hold"].astype(float)
    both = Sheet(
        **{
            f.name: np.concatenate([getattr(sheet, f.name), new[f.name]])
            if f.name in new
            else getattr(sheet, f.name)
            for f in fields(Sheet)
        }
    )
    added = _begun(case, new, rng)
    both.first = sheet.first or len(sheet.mode)
    both.begun = {k: np.concatenate([v, added[k]]) for k, v in sheet.begun.items()}
    both.state = dict(both.begun)
    disturb(both, case.effects)
    before = len(sheet.mode)
    both.state = {k: np.concatenate([sheet.state[k], v[before:]]) for k, v in both.state.items()}
    return replace(case, sheet=both)


def _begun(case: Case, new: dict, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """State of the new records before the effects: scatter as of the campaign."""
    sheet, bench = case.sheet, case.bench
    holds, where = np.unique(new["hold"], return_inverse=True)
    draws = rng.standard_t(3, (3, len(holds))) / np.sqrt(3) if bench.heavy else None
    draws = rng.normal(size=(3, len(holds))) if draws is None else draws
    first = {m: np.flatnonzero(sheet.mode == m)[0] for m in np.unique(sheet.mode)}
    bias = np.array([sheet.begun["bias"][first[m]] for m in new["mode"]])
    count = len(new["mode"])
    newtons = 10.0 * bench.piston_cm2
    return {
        "ln_kn": sheet.specimen.ln_kn + bench.scatter * draws[0][where],
        "ln_kt": sheet.specimen.ln_kt + bench.scatter * draws[1][where],
        "force": new["reading"] + newtons * rng.uniform(-0.5, 0.5, len(holds))[where],
        "ln_f": bias + 1.5e-5 * rng.normal(size=count),
        "ln_eta": 0.03 * draws[2][where] + 0.005 * rng.normal(size=count),
        "bias": bias,
        "eta": np.array([bench.loss[m] for m in new["mode"]]),
    }
