"""The blind matrix: many sealed cases, the diagnosis on each, and what it was worth.

python tests/blind/matrix.py --tier fast --cases 300 [--seed N | --score] [--power] [--minutes M]
    [--table FILE]

Without a seed the tuning seed of seeds.yaml is used. --score freezes: it draws a fresh seed after
the last commit, writes it to seeds.yaml, and uses it. --power runs sizes below the bounds.
"""

import argparse
import json
import shutil
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from tempfile import gettempdir

import numpy as np
import pandas as pd
import xarray as xr
from cases import Case, catalogue, draw_bench, draw_case, outsiders
from fast import save
from findings import build_library
from lab import Laboratory
from runs import diagnose, make, structures
from score import left_over, score
from seal import open_seal, seal
from seeds import draw_scoring_seed, tuning_seed
from tables import matrix_page
from tuning import effect

# Of a matrix's cases: nulls, effects of no catalogue, pairs; the others hide one effect.
NULLS, OUTSIDE, PAIRS = 0.2, 0.15, 0.1
# What would split the level pair: measurement and its standard deviation, a fifth of the effect's
# bound (which is then worth 12 nats, less what the prior asks).
SPLITTERS = {"modulus-density": ("free-free", 0.002), "rig-compliance": ("rig stiffness", 0.01)}
NOT_SPLIT = dict.fromkeys(("split", "split_between_forces", "split_k"), np.nan)
POWER = (0.125, 0.25, 0.5, 1.0, 2.0)


def planned(count: int, entropy: int) -> list[Case]:
    """Cases of a matrix in a drawn order: no position tells what is hidden."""
    chance = np.random.default_rng([entropy, 7])
    nulls, outside, pairs = (round(part * count) for part in (NULLS, OUTSIDE, PAIRS))
    singles = _cycled([(name,) for name in catalogue()], count - nulls - outside - pairs, chance)
    hidden = [()] * nulls + singles
    hidden += _cycled([(name,) for name in outsiders()], outside, chance)
    hidden += [_pair(chance) for _ in range(pairs)]
    order = chance.permutation(len(hidden))
    return [draw_case(_own(entropy, k), hidden[which]) for k, which in enumerate(order)]


def planned_power(count: int, entropy: int) -> list[tuple[Case, float]]:
    """Cases of every effect at sizes from an eighth of its bound to twice it, `count` each."""
    wanted = [(name, size) for name in catalogue() for size in POWER for _ in range(count)]
    return [
        (draw_case(_own(entropy, k), (name,), size), size) for k, (name, size) in enumerate(wanted)
    ]


def _own(entropy: int, number: int) -> int:
    return int(np.random.default_rng([entropy, 8, number]).integers(2**62))


def _cycled(names: list, count: int, chance: np.random.Generator) -> list:
    rounds = count // len(names) + 1
    return [names[i] for _ in range(rounds) for i in chance.permutation(len(names))][:count]


def _pair(chance: np.random.Generator) -> tuple[str, str]:
    """Two effects of different classes that show in curves."""
    names = [name for name in catalogue() if effect(name).CLASS not in ("record", "level")]
    while True:
        one, two = chance.choice(names, 2, replace=False)
        if effect(str(one)).CLASS != effect(str(two)).CLASS:
            return str(one), str(two)


_SHARED: dict[str, Laboratory] = {}


def _share(lab: Laboratory) -> None:
    _SHARED["lab"] = lab


def _run_shared(parametric: Path, house: Path, tier: str, work: tuple[int, Case]) -> dict:
    return run_case(_SHARED["lab"], parametric, house, tier, work)


def run_case(
    lab: Laboratory,
    parametric: Path,
    house: Path,
    tier: str,
    work: tuple[int, Case],
    sheet: pd.DataFrame | None = None,
) -> dict:
    """Make one case, seal it, diagnose what a run may see, open the seal and score.

    `sheet` is a campaign's records where they are not those that the case draws.
    """
    number, case = work
    sealed, seen = house / "sealed" / f"c{number:04d}", house / "cases" / f"c{number:04d}"
    shown = seal(case.answer(), sealed)
    began = time.monotonic()
    if tier == "fast":
        save(lab.fast(case, sheet), seen / "observations.nc")
        made = time.monotonic()
        verdict = diagnose(seen / "observations.nc", parametric)
        diagnosed = time.monotonic()
        stiffness = _stiffness(case, seen / "diagnosis.nc")
        split = _split(case, seen, parametric)
    else:
        campaign = house / "campaigns" / f"c{number:04d}"
        shutil.rmtree(campaign, ignore_errors=True)
        lab.raw(case, campaign, sheet)
        made = time.monotonic()
        name = f"results/{campaign.name}/diagnosis/verdict.json"
        make(house, name, campaign=campaign)
        path = house / name
        stiffness = _stiffness(case, path.with_name(f"{draw_bench(case.seed)['structure']}.nc"))
        verdict = json.loads(path.read_text(encoding="utf-8"))
        shutil.rmtree(campaign)
        diagnosed, split = time.monotonic(), {}
    answer = open_seal(sealed, shown)
    return {
        "hidden": "+".join(sorted(name for name, _ in answer["effects"])) or "nothing",
        "sizes": [size for _, size in answer["effects"]],
        "answer": verdict["answer"],
        "bench_s": made - began,
        "verdict_s": diagnosed - made,
        **NOT_SPLIT,
        **split,
        **left_over(verdict),
        **stiffness,
        **asdict(score(answer, verdict)),
    }


def _split(case: Case, seen: Path, parametric: Path) -> dict[str, float]:
    """What one of the level pair is worth once its own measurement is there; empty for others.

    Whether it is named, and what is then left of the error between forces and of kn and kt.
    """
    if len(case.effects) != 1 or case.effects[0][0] not in SPLITTERS:
        return {}
    name, size = case.effects[0]
    measurement, std = SPLITTERS[name]
    error = std * np.random.default_rng([case.seed, 9]).standard_normal()
    told = {"measurement": measurement, "value": float(size + error), "std": std}
    verdict = diagnose(seen / "observations.nc", parametric, {"independent": [told]})
    stiffness = _stiffness(case, seen / "diagnosis.nc")
    return {
        "split": score(case.answer(), verdict).named,
        "split_between_forces": left_over(verdict)["between_forces_without_bias"],
        "split_k": stiffness["k_after"] / stiffness["k_before"],
    }


def _stiffness(case: Case, diagnosis: Path) -> dict[str, float]:
    """By how much kn, kt of the specimen are missed (rms of ln) at 12 kN, before and after.

    `k_away` is that of the worse one after in its standard deviations.
    """
    joint = draw_bench(case.seed)["joint"]
    true = np.log([joint["kn_N_per_m"], joint["kt_N_per_m"]])
    with xr.open_dataset(diagnosis) as found:
        if "law_k" not in found:
            return dict.fromkeys(("k_before", "k_after", "k_away"), np.nan)
        here = found[["law_k", "law_ln_std"]].sel(law_force=joint["reference_force_N"]).load()
    off = np.log(here["law_k"].values) - true
    before, after = np.sqrt((off**2).mean(axis=1))
    away = np.abs(off[1] / here["law_ln_std"].values[1]).max()
    return {"k_before": float(before), "k_after": float(after), "k_away": float(away)}


def laboratory(house: Path, library_seed: int) -> tuple[Laboratory, Path]:
    """Structure and library of findings of a house, made if they are not there."""
    structure = structures(house)
    table = house / "findings.csv"
    if not table.is_file():
        build_library(house, structure / "reduced.nc", library_seed).to_csv(table, index=False)
    library = pd.read_csv(table, keep_default_na=False)
    return Laboratory(structure / "reduced.nc", library), structure / "parametric.nc"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tier", choices=("fast", "raw"), default="fast")
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--score", action="store_true", help="draw a fresh seed; needs a commit")
    parser.add_argument("--power", action="store_true", help="sizes below the bounds; cases each")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, help="take no further case after so long")
    parser.add_argument("--house", type=Path, default=Path(gettempdir()) / "bladeroot-blind")
    parser.add_argument("--table", type=Path, help="Markdown to write instead of showing it")
    options = parser.parse_args()
    drawn = draw_scoring_seed() if options.score else {"seed": options.seed or tuning_seed()}
    lab, parametric = laboratory(options.house, tuning_seed())
    if options.power:
        planned_cases, sizes = zip(*planned_power(options.cases, drawn["seed"]), strict=True)
    else:
        planned_cases = planned(options.cases, drawn["seed"])
        sizes = [None] * len(planned_cases)
    # A raw case keeps all cores busy by itself.
    jobs = options.jobs if options.tier == "fast" else 1
    one = partial(_run_shared, parametric, options.house, options.tier)
    lab.few  # noqa: B018 - worked out once, before the processes part
    outcomes, began = [], time.monotonic()
    with ProcessPoolExecutor(jobs, initializer=_share, initargs=(lab,)) as pool:
        for number, outcome in enumerate(pool.map(one, enumerate(planned_cases))):
            outcomes.append({**outcome, "relative_size": sizes[number]})
            print(f"{number + 1}: {outcome['hidden']} -> {outcome['column']}", file=sys.stderr)
            if options.minutes and time.monotonic() - began > 60 * options.minutes:
                # The order was drawn: the cases so far are a sample of all, whatever they gave.
                pool.shutdown(wait=False, cancel_futures=True)
                break
    table = pd.DataFrame(outcomes)
    table.to_json(options.house / "outcomes.json", orient="records")
    text = matrix_page(table, drawn, options.tier)
    if options.table:
        options.table.write_text(text, encoding="utf-8")
    else:
        print(text)


if __name__ == "__main__":
    main()
