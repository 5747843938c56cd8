"""One sealed campaign: its specimen, design, hidden effects; its files; its truth."""

import hashlib
import json
import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import netCDF4
import numpy as np
import yaml

from foreign_lab.design import Bench, draw_bench, draw_sheet, undisturbed
from foreign_lab.effect import Effect, draw_effect, pool
from foreign_lab.jointed_beam import export
from foreign_lab.motion import raw_record
from foreign_lab.sheet import Record, Sheet
from foreign_lab.specimen import Specimen, specimen

KINDS = {"null": 0.2, "single": 0.42, "pair": 0.16, "outside": 0.22}
# Two of a class are one question, not two effects.
CLASSES = (
    {"joint-slip", "normal-load-variation", "geometric-hardening", "quadratic-drag"},
    {"load-dependent-stiffness", "incomplete-contact", "force-gain"},
    {"force-offset", "added-mass", "modulus-density", "rig-compliance"},
    {"drift", "force-relaxation"},
    {"loading-hysteresis"},
    {"clipping", "shaker-recontact", "mode-beating", "mains-hum"},
)
# These change the force that the others then feel.
FIRST = ("force-gain", "force-offset", "gauge-friction", "force-relaxation")
# An effect on stick frequencies is made larger until its rms over the records is this part of the
# clampings' scatter, or its law's largest size is reached; level effects are what they are.
VISIBLE = 0.8
TRIES = 20  # draws of effects until the design can show them
BIAS = 0.004  # of a mode's ln f; the analyst's dimensions and modulus make it 0.5 % in all


@dataclass(frozen=True)
class Case:
    """A campaign before it is written."""

    seed: int
    kind: str
    effects: tuple[Effect, ...]
    sheet: Sheet
    bench: Bench

    @property
    def specimen(self) -> Specimen:
        """What was measured."""
        return self.sheet.specimen


def draw_case(seed: int, cache: Path, shipped: Path, kind: str = "", effect: str = "") -> Case:
    """The campaign of a seed. `kind` and `effect` (an id) may be set, for tuning.

    A pair with a set effect is that and another one.
    """
    made = specimen(seed, cache, shipped)
    rng = np.random.default_rng([seed, 3])
    laws = pool(spare=bool(effect) and kind != "pair")
    drawn = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    kind = kind or (drawn if not effect else "outside" if _outside(laws[effect]) else "single")
    bench = draw_bench(rng, made)
    sheet = draw_sheet(rng, made, bench)
    sheet.state = undisturbed(rng, sheet, bench, BIAS)
    sheet.state["eta"] = np.array([bench.loss[m] for m in sheet.mode])
    sheet.begun = dict(sheet.state)
    for _ in range(TRIES):
        effects = [
            _grown(draw_effect(rng, law), sheet, bench) for law in _chosen(rng, kind, laws, effect)
        ]
        # a design without, say, unloading cannot show some effects at any size
        if all(_seen(one, sheet, bench) > VISIBLE / 2 for one in effects):
            break
    effects.sort(key=lambda one: (FIRST.index(one.id) if one.id in FIRST else 9, one.id))
    disturb(sheet, effects)
    return Case(seed, kind, tuple(effects), sheet, bench)


def disturb(sheet: Sheet, effects: Sequence[Effect]) -> None:
    """Change the state by the effects, one after the other."""
    for one in effects:
        for name, change in (one.call("stick", sheet) or {}).items():
            sheet.state[name] = sheet.state[name] + change


def _grown(effect: Effect, sheet: Sheet, bench: Bench) -> Effect:
    while _seen(effect, sheet, bench) < VISIBLE and not effect.at_most():
        effect = effect.larger(1.2)
    return effect


def _outside(law) -> bool:
    return getattr(law, "OUTSIDE", False)


def _chosen(rng: np.random.Generator, kind: str, laws: dict, effect: str) -> list:
    listed = [name for name, law in laws.items() if not _outside(law)]
    if effect and kind != "pair":
        return [laws[effect]]
    if kind == "null":
        return []
    if kind == "outside":
        others = [name for name in laws if name not in listed]
        return [laws[others[rng.integers(len(others))]]]
    first = effect or listed[rng.integers(len(listed))]
    if kind == "single":
        return [laws[first]]
    own = next(one for one in CLASSES if first in one)
    rest = [name for name in listed if name not in own]
    return [laws[first], laws[rest[rng.integers(len(rest))]]]


def _seen(effect: Effect, sheet: Sheet, bench: Bench) -> float:
    """rms over the records of what it does to ln f, level left out, over the clampings' scatter."""
    change = effect.call("stick", sheet)
    if change is None or effect.id in CLASSES[2] or set(change) <= {"ln_eta"}:
        return np.inf
    if not any(np.abs(part).max() > 0 for part in change.values()):
        return np.inf if hasattr(effect.law, "curve") else 0.0
    moved = {name: part + change.get(name, 0.0) for name, part in sheet.state.items()}
    shift = sheet.ln_frequency(moved) - sheet.ln_frequency()
    seen = []
    for mode, surface in sheet.specimen.surfaces.items():
        mine = sheet.mode == mode
        if not mine.any():
            continue
        point = (sheet.specimen.ln_kn, sheet.specimen.ln_kt, sheet.reference)
        usual = bench.scatter * np.hypot(surface.slope(0, *point), surface.slope(1, *point))
        seen.append(np.std(shift[mine]) / usual)
    return float(max(seen))


def write_campaign(case: Case, folder: Path, raw: bool = True) -> None:
    """campaign.yaml, records.csv, raw/*.nc and, unless the structure is shipped, its matrices.

    Without `raw` the records' files are empty.
    """
    sheet, bench = case.sheet, case.bench
    rng = np.random.default_rng([case.seed, 4])
    (folder / "raw").mkdir(parents=True)
    name = case.specimen.name
    if case.specimen.told is not None:
        export(case.specimen.told, folder, name)
    f = np.exp(sheet.ln_frequency())
    modes = {
        mode: {
            "expected_Hz": float(10 * round(np.median(f[sheet.mode == mode]) / 10)),
            "laser_x_mm": round(1e3 * case.specimen.laser[mode], 2) + 0.0,
        }
        for mode in ("1B", "2B")
    }
    described = {
        "title": "Joint rig, ring-down series",
        "structure": [name],
        "modes": modes,
        "force": {
            "gauge": "pressure",
            "piston_area_cm2": bench.piston_cm2,
            "full_scale_bar": 300,
            "accuracy_percent": 1,
            "accuracy_of": "full-scale",
        },
    }
    (folder / "campaign.yaml").write_text(yaml.safe_dump(described, sort_keys=False))
    columns = ["record", "file", "mode", "pressure_bar", "hold"]
    columns += [] if bench.hides_direction == "all" else ["direction"]
    columns += [] if bench.hides_time else ["time_s"]
    lines = [",".join(columns)]
    for k in range(len(sheet.mode)):
        record = f"m{k + 1:03d}"
        way = "up" if sheet.direction[k] > 0 else "down"
        if bench.hides_direction == "some" and rng.random() < 0.3:
            way = ""
        row = {
            "record": record,
            "file": f"raw/{record}.nc",
            "mode": sheet.mode[k],
            "pressure_bar": f"{sheet.reading[k] / (10 * bench.piston_cm2):.0f}",
            "hold": f"c{sheet.hold[k]}",
            "direction": way,
            "time_s": f"{sheet.time[k]:.0f}",
        }
        lines.append(",".join(row[column] for column in columns))
        if not raw:
            (folder / row["file"]).touch()
            continue
        digits, step = raw_record(
            np.random.default_rng([case.seed, 5, k]), Record(sheet, k), bench, case.effects
        )
        _save(folder / row["file"], digits, step, bench.sampling_Hz)
    (folder / "records.csv").write_text("\n".join(lines) + "\n")


def _save(path: Path, digits: np.ndarray, step: float, sampling: float) -> None:
    with netCDF4.Dataset(path, "w") as file:
        file.sampling_Hz = sampling
        file.createDimension("time", len(digits))
        variable = file.createVariable("velocity", "i2", ("time",))
        variable.set_auto_maskandscale(False)
        variable.scale_factor, variable.units = step, "m/s"
        variable[:] = digits


def truth(case: Case) -> dict:
    """All that was hidden, for the scorer alone."""
    return {
        "seed": case.seed,
        "kind": case.kind,
        "specimen": case.specimen.name,
        "records": len(case.sheet.mode),
        "scatter": case.bench.scatter,
        "heavy": case.bench.heavy,
        "noise_dB": case.bench.noise_dB,
        "hides": [case.bench.hides_direction, case.bench.hides_time],
        "effects": [
            {
                "id": one.id,
                "form": one.form,
                "size": one.size,
                "unit": one.law.UNIT,
                "shape": one.shape,
                "outside": one.outside,
                "kin": list(one.kin),
                "visible": _finite(_seen(one, case.sheet, case.bench)),
                "measures": one.call("measures", case.sheet) or {},
            }
            for one in case.effects
        ],
    }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def seal(case: Case, path: Path) -> str:
    """Write the truth with a salt, and its SHA-256 beside it; the digest."""
    text = json.dumps({"salt": secrets.token_hex(16), **truth(case)}, indent=1) + "\n"
    digest = hashlib.sha256(text.encode()).hexdigest()
    path.write_text(text)
    path.with_suffix(".sha256").write_text(digest + "\n")
    return digest


def opened(path: Path) -> dict:
    """The sealed truth; ValueError if it was changed after sealing."""
    text = path.read_text()
    said = path.with_suffix(".sha256").read_text().strip()
    if hashlib.sha256(text.encode()).hexdigest() != said:
        raise ValueError(f"the truth is not what was sealed ({path})")
    return json.loads(text)
