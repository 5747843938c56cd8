"""Synthetic decays: errors, coverage and distance from the Cramer-Rao bound, peers beside.

    python benchmarks/decays.py                 # about five minutes on one core
    python benchmarks/decays.py --small         # about twenty seconds
    python benchmarks/decays.py --seed 7 --cases 200 --peer-cases 0 --json found.json

Truths, second modes and noise are drawn afresh at every run; the seed is printed. `synthetic.py`
says what is drawn, `scores.py` and `peers.py` what each number is.
"""

import argparse
import json
import secrets
from collections import defaultdict
from dataclasses import asdict

import numpy as np
import peers
from scores import bladeroot_scores, peer_scores
from synthetic import draw

# by noise in dB: largest median errors (ppm, %, ppm)
TARGETS = {
    60: {"frequency": 20.0, "loss": 1.0, "stick": 3.0},
    40: {"frequency": 60.0, "loss": 6.0, "stick": 25.0},
}
SLACK = {68: 5.0, 95: 3.0}  # largest distance of the shares within the intervals, in %
BOUND_RATIO = 2.0
CURVES = ("amplitude", "frequency", "loss_factor")
MEDIANS = ("frequency", "own frequency", "loss", "own loss", "stick", "stick loss")


def best_setting(records: list[dict[str, dict[str, float]]]) -> tuple[str, dict[str, float]]:
    """The setting of a peer that does best over the records, and its medians.

    Best in frequency over what the curve keeps, or in stick frequency for a tool without one;
    but `met` is the largest mean of any setting, and `closest` the smallest ratio of its frequency
    error to bladeroot's at the same amplitudes.
    """
    choices = []
    for setting in sorted({setting for record in records for setting in record}):
        results = [record.get(setting, {}) for record in records]
        medians = {key: median([result.get(key, np.nan) for result in results]) for key in MEDIANS}
        medians["reach"] = float(np.mean([result.get("reach", np.nan) for result in results]))
        medians["met"] = float(np.mean([result.get("met", 0.0) for result in results]))
        choices.append((setting, medians))
    if not choices:
        return "", dict.fromkeys((*MEDIANS, "reach", "closest"), np.inf) | {"met": 0.0}
    setting, best = min(choices, key=lambda one: (one[1]["frequency"], one[1]["stick"]))
    met = max(medians["met"] for _, medians in choices)
    ratios = [
        medians["frequency"] / medians["own frequency"]
        for _, medians in choices
        if np.isfinite(medians["frequency"])
    ]
    return setting, best | {"met": met, "closest": min(ratios, default=np.inf)}


def median(values: list[float]) -> float:
    """Median in which a missing result counts as infinitely wrong."""
    return float(np.median(np.where(np.isfinite(values), values, np.inf)))


def verdict(ok: bool) -> str:
    return "ok" if ok else "FAILS"


def judge(beyond: float) -> str:
    """Verdict on a share that lies so many of its own errors outside what is allowed."""
    return "ok" if beyond <= 0.0 else "FAILS" if beyond > 2.0 else "open"


def report_accuracy(scores: dict[int, list[dict[str, float]]]) -> dict:
    print("\nmedian over records; RMS over amplitudes 0.02 to 0.95 of the start (worst tenth)")
    print("noise  f RMS ppm         eta RMS %         reach %  stick ppm (bound)  eta0 %  onset %")
    summary = {}
    for db, records in scores.items():
        column = {key: [record[key] for record in records] for key in records[0]}
        mid = {
            key: median(column[key])
            for key in ("frequency", "loss", "stick", "stick loss", "onset")
        }
        worst = {key: float(np.quantile(column[key], 0.9)) for key in ("frequency", "loss")}
        reach = 100.0 * float(np.mean(column["reach"]))
        missing = int(np.sum(~np.isfinite(column["stick"])))
        print(
            f"{db:2d} dB {mid['frequency']:8.2f} ({worst['frequency']:7.1f})"
            f" {mid['loss']:8.3f} ({worst['loss']:6.2f}) {reach:8.1f}"
            f" {mid['stick']:8.3f} ({median(column['stick bound']):.3f})"
            f" {mid['stick loss']:10.3f} {mid['onset']:8.2f}"
            + (f"   no plateau in {missing} of {len(records)}" if missing else "")
        )
        summary[db] = mid | {"reach": reach, "no plateau": missing}
    for db in [db for db in TARGETS if db in scores]:
        for key, most in TARGETS[db].items():
            found = summary[db][key]
            print(f"target {db} dB {key:9s} {found:8.3f} <= {most:5.1f}  {verdict(found <= most)}")
    return summary


def report_bound(scores: dict[int, list[dict[str, float]]]) -> dict:
    print("\nplateau against the Cramer-Rao bound, median over records (target at most 2)")
    print("noise  stick: error/bound  std/bound   loss factor: error/bound  std/bound")
    summary = {}
    names = [
        f"{part} {kind}/bound"
        for part in ("stick_frequency", "plateau_loss")
        for kind in ("error", "std")
    ]
    for db, records in scores.items():
        summary[db] = {name: median([record[name] for record in records]) for name in names}
        a, b, c, d = summary[db].values()
        bad = "" if max(a, c) <= BOUND_RATIO else "   FAILS"
        print(f"{db:2d} dB {a:19.2f} {b:10.2f} {c:26.2f} {d:10.2f}{bad}")
    return summary


def report_coverage(scores: dict[int, list[dict[str, float]]]) -> dict:
    print(
        "\n% of truths within the stated 68 % and 95 % intervals (+- error of this figure itself)"
    )
    levels = dict(scores.items()) | {
        "all": [record for records in scores.values() for record in records]
    }
    print("                    " + "".join(f"{db!s:>22}" for db in levels))
    summary = defaultdict(dict)
    for name in (*CURVES, "stick_frequency", "plateau_loss", "onset"):
        cells, beyond = [], {}
        for db, records in levels.items():
            cell, beyond[db] = [], -np.inf
            for percent, slack in SLACK.items():
                values = np.array([record[f"{name} {percent}"] for record in records], float)
                values = values[np.isfinite(values)]
                mean = float(values.mean()) if values.size else np.nan
                # a record is inside or not, or has a share of its curve inside, which is at
                # least as certain as ten independent points
                spread = np.sqrt(percent * (100.0 - percent))
                if name in CURVES and values.size:
                    spread = max(values.std(), spread / np.sqrt(10.0))
                error = float(spread / np.sqrt(max(values.size, 1)))
                cell.append(f"{mean:5.1f}+-{error:3.1f}")
                summary[name][f"{db} {percent}"] = mean
                beyond[db] = max(beyond[db], (abs(mean - percent) - slack) / max(error, 1e-9))
            cells.append(" ".join(cell))
        print(
            f"{name:18s}  "
            + "".join(f"{cell:>22}" for cell in cells)
            + f"  {judge(beyond['all'])}; at each noise {judge(max(beyond.values()))}"
        )
    return summary


def report_peers(scores: dict, rivals: dict[int, list[dict]]) -> dict:
    summary: dict[int, dict] = {}
    units = {
        "frequency": "f RMS ppm",
        "loss": "eta RMS %",
        "stick": "stick ppm",
        "stick loss": "eta0 %",
    }
    for db, records in rivals.items():
        if not records:
            continue
        print(
            f"\n{db} dB, over {len(records)} records; * not behind bladeroot (behind the stroke: "
            f"bladeroot at the same amplitudes)\n{'':28s}    reach  met %"
            + "".join(f"{unit:>18s} " for unit in units.values())
        )
        own = {key: median([record[key] for record in scores[db][: len(records)]]) for key in units}
        for share in ("reach", "met"):
            own[share] = float(np.mean([record[share] for record in scores[db][: len(records)]]))
        summary[db] = {"bladeroot": own}
        for name in dict.fromkeys(name for record in records for name in record):
            setting, best = best_setting([record.get(name, {}) for record in records])
            summary[db][name] = best | {"setting": setting}
        for name, best in summary[db].items():
            cells = [f"{name:28s}"]
            for share in ("reach", "met"):
                curve = np.isfinite(best["frequency"])
                cells.append(f"{100.0 * best[share]:7.1f}" if curve else f"{'-':>7s}")
            for key in units:
                ours = best.get(f"own {key}", own[key])
                rival = name != "bladeroot" and np.isfinite(best[key])
                mark = "*" if rival and best[key] <= ours else " "
                same = f" | {ours:7.3f}" if np.isfinite(best.get(f"own {key}", np.inf)) else ""
                cells.append(f"{best[key]:9.3f}{same:10s}{mark}".replace("inf", "  -"))
            closest = best.get("closest", np.inf)
            told = f" (closest of all settings: {closest:.1f} times)" if closest < np.inf else ""
            print(*cells, best.get("setting", "") + told)
    return summary


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, help="repeat a run; drawn afresh if not given")
    parser.add_argument("--cases", type=int, default=36, help="records at each noise level")
    parser.add_argument("--peer-cases", type=int, default=10, help="of these, given to the peers")
    parser.add_argument("--noise", type=int, nargs="+", default=[80, 60, 40, 30], help="dB")
    parser.add_argument("--small", action="store_true", help="2 records, 1 for the peers, 2 levels")
    parser.add_argument("--json", help="file for all of this and the scores of each record")
    options = parser.parse_args()
    if options.small:
        options.cases, options.noise = 2, [60, 40]
        options.peer_cases = min(options.peer_cases, 1)
    if options.peer_cases:
        peers.require()
    seed = secrets.randbits(64) if options.seed is None else options.seed
    print(f"seed {seed}, {options.cases} records a noise level, peers {options.peer_cases}")
    scores: dict[int, list] = {db: [] for db in options.noise}
    rivals: dict[int, list] = {db: [] for db in options.noise}
    records: list[dict] = []
    for k in range(options.cases):
        law_seed = np.random.SeedSequence(seed, spawn_key=(k,))
        for db in options.noise:
            case = draw(law_seed, np.random.SeedSequence(seed, spawn_key=(k, db)), db)
            about = {"second": (case.second_ratio, case.second_share), "law": asdict(case.law)}
            score, errors = bladeroot_scores(case)
            scores[db].append(score)
            records.append({"record": k, "noise_dB": db} | about | {"score": scores[db][-1]})
            if k < options.peer_cases:
                rivals[db].append(peer_scores(case, errors))
    summary = {
        "seed": seed,
        "cases": options.cases,
        "accuracy": report_accuracy(scores),
        "bound": report_bound(scores),
        "coverage": report_coverage(scores),
        "peers": report_peers(scores, rivals),
    }
    seconds = [record["seconds"] for records in scores.values() for record in records]
    print(f"\nfreevib and plateau: {np.median(seconds):.2f} s a record (median)")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(summary | {"records": records}, file, indent=1, default=float)


if __name__ == "__main__":
    main()
