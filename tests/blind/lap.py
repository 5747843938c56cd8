"""Blind cases of the lap joint, fast tier: joint slip, stiffness over the load, added mass, none.

python tests/blind/lap.py [--cases 24] [--seed N]

The bench is that of the campaign `lap-joint` with two interfaces, drawn as the
dovetail's is (`cases.py`): stiffness constant over the preload and no slip, unless that is hidden.
The diagnosis knows its four stiffnesses to a factor of 30 and frequencies to 0.15 %.
"""

import argparse
import sys
import time
from collections import defaultdict
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/lib"))

import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import yaml  # noqa: E402
from bladeroot import artifacts  # noqa: E402
from cases import Case, draw_case  # noqa: E402
from fast import save  # noqa: E402
from lab import Laboratory  # noqa: E402
from lap_coarse import lap_shipped  # noqa: E402
from runs import diagnose  # noqa: E402
from score import Outcome, score, share  # noqa: E402
from seal import open_seal, seal  # noqa: E402

HIDDEN = ((), ("joint-slip",), ("load-dependent-stiffness",), ("added-mass",))
BENCH = ROOT / "resources/bench/lap-joint.yaml"
EXPECTED = {"bend1": 165.0, "bend2": 585.0, "bend3": 1160.0}  # Hz
LOSS = (0.002, 0.006)
# Drive (A) of each mode, to amplitudes at which slip begins under one friction (40, 24 and 7 um): a
# mode that is driven far below says nothing of the joint.
DRIVES = {"bend1": 25.0, "bend2": 160.0, "bend3": 370.0}
PRELOADS, CYCLES = (300, 500, 700, 900, 1200), 2  # ten newtons each
FACTS = {
    "expected_Hz": EXPECTED,
    "fe_bias_percent": dict.fromkeys(EXPECTED, 0.15),
    "fe_offset_percent": {},
}


def draw_bench(seed: int) -> dict:
    """The bench of a case: no law is right but the hidden one."""
    bench = yaml.safe_load(BENCH.read_text(encoding="utf-8"))
    chance = np.random.default_rng([seed, 2])
    bench["seed"], bench["gauge"]["gain"] = seed, 1.0
    for name in ("modulus_factor", "density_factor"):
        bench["specimen"][name] = float(np.exp(0.001 * chance.standard_normal()))
    for name in ("kn", "kt"):
        bench["joint"][f"{name}_N_per_m"] *= float(np.exp(chance.uniform(-0.4, 0.4)))
        bench["joint"][f"{name}_exponent"] = 0.0
    bench["friction"] |= {"coefficient": np.inf}
    drawn = {mode: float(np.exp(chance.uniform(*np.log(LOSS)))) for mode in EXPECTED}
    bench["damping"]["loss_factor"] = drawn
    longest = {mode: 2.0 / (LOSS[0] * 2.0 * np.pi * f) for mode, f in EXPECTED.items()}
    bench["recording"]["time_constant_s"] = longest
    bench["laser"]["noise_m_per_s"] = float(np.exp(chance.uniform(*np.log([3e-6, 3e-5]))))
    return bench


def draw_sheet(seed: int) -> pd.DataFrame:
    """Every preload up and down, all modes in each hold."""
    chance = np.random.default_rng([seed, 3])
    ways = [("up", PRELOADS), ("down", PRELOADS[::-1])] * CYCLES
    rows, clock = [], 0
    for number, (way, load) in enumerate(((w, load) for w, all_ in ways for load in all_), 1):
        for mode, usual in DRIVES.items():
            name = f"r{len(rows) + 1:03d}"
            drive = round(usual * float(chance.uniform(0.95, 1.05)), 3)
            rows.append({"record": name, "file": f"{name}.nc", "mode": mode, "pressure_bar": load,
                         "hold": f"h{number:02d}", "direction": way, "time_s": clock,
                         "drive_A": drive})  # fmt: skip
            clock += 180
        clock += 900
    return pd.DataFrame(rows)


def laboratory(folder: Path) -> Laboratory:
    """With the shipped lap joint as the specimen: the first of few pairs to slip is a step."""
    for name, made in zip(("reduced", "parametric"), lap_shipped(), strict=True):
        artifacts.save(made, folder / f"{name}.nc")
    return Laboratory(folder / "reduced.nc", bench=draw_bench, sheet=draw_sheet)


def run_case(lab: Laboratory, case: Case, sealed: Path) -> tuple[dict, Outcome]:
    """Seal, diagnose what a run may see, open and score."""
    shown = seal(case.answer(), sealed)
    seen = lab.fast(case).assign_attrs(load_name="bolt preload", load_unit="N")
    save(seen, sealed.with_name(f"{sealed.name}-seen") / "observations.nc")
    verdict = diagnose(sealed.with_name(f"{sealed.name}-seen") / "observations.nc",
                       lab.reduced.with_name("parametric.nc"), FACTS)  # fmt: skip
    return verdict, score(open_seal(sealed, shown), verdict)


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--cases", type=int, default=24)
    asked.add_argument("--seed", type=int, default=90210)
    options = asked.parse_args()
    began, found = time.process_time(), defaultdict(list)
    with TemporaryDirectory() as name:
        lab = laboratory(Path(name))
        for k in range(options.cases):
            names = HIDDEN[k % len(HIDDEN)]
            case = draw_case(options.seed + k, names)
            verdict, outcome = run_case(lab, case, Path(name) / f"c{k}")
            hidden = "+".join(names) or "nothing"
            found[hidden].append(outcome)
            leading = "+".join(one["mechanism"] for one in verdict["causes"])
            print(f"{k + 1}: {hidden} -> {verdict['answer']} {leading}", flush=True)
    for hidden, outcomes in found.items():
        none = hidden == "nothing"
        hits = sum(one.column == "nothing-missing" if none else one.named > 0 for one in outcomes)
        family = hits if none else sum(one.classed > 0 for one in outcomes)
        wrong = sum(one.wrong for one in outcomes)
        _, low, high = share(hits, len(outcomes))
        print(f"{hidden}: right {hits} of {len(outcomes)} ({low:.0%} to {high:.0%}), at least its "
              f"class {family}, wrong name {wrong}")  # fmt: skip
    print(f"seed {options.seed}, {time.process_time() - began:.0f} CPU-s")


if __name__ == "__main__":
    main()
