"""The diagnosis on campaigns of a laboratory that was made by somebody who had not read it.

    python benchmarks/stranger.py --seeds 1-10                    # in a folder that is thrown away
    python benchmarks/stranger.py --seeds 1-10 --out DIR --json FILE
    python benchmarks/stranger.py --seeds 3 --effect slip         # or --kind outside

A seed draws what is hidden, the specimen, the campaign and its raw records (`stranger_lab/`); its
folder is given to `br.diagnose` as it is. `--out` keeps the campaigns (`cSEED`), their truths and
their verdicts; a verdict that is there is not made again. A name is certain if its cause is `shown`
and alone in its credible set. Seeds 1 to 99 are for tuning.
"""

import argparse
import json
import os
import shutil
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from stranger_lab.bench import Bench  # noqa: E402
from stranger_lab.files import write_campaign  # noqa: E402
from stranger_lab.plan import KINDS  # noqa: E402

# What the catalogue may call each effect: the same physics under another word is as good.
FAIR = {
    "slip": {"joint-slip"},
    "contact-law": {"load-dependent-stiffness", "incomplete-contact"},
    "seating": {"incomplete-contact", "load-dependent-stiffness"},
    "gain": {"force-gain"},
    "zero": {"force-offset"},
    "lagging-load": {"gauge-friction", "loading-hysteresis"},
    "relaxation": {"force-relaxation"},
    "temperature": {"temperature", "drift"},
    "drift": {"drift"},
    "ageing": {"ageing"},
    "tip-mass": {"added-mass"},
    "crack": {"crack"},
    "hardening": {"geometric-hardening"},
    "drag": {"quadratic-drag"},
    "clipping": {"clipping"},
    "hum": {"mains-hum"},
    "touch": {"shaker-recontact"},
    "normal-load": {"normal-load-variation"},
    "beating": {"mode-beating"},
    "cable": {"geometric-hardening"},
    "humidity": {"damping-drift"},
    "magnet": {"force-dependent-damping"},
    "breathing": {"normal-load-variation"},
    "rattle": set(),
    "rubber": set(),
    "operator": set(),
}
OTHER = "none-of-these"
SEEN = 0.05  # of "none": a null is then among what an ambiguous verdict leaves
OUTCOMES = (
    "right certain", "part right", "wrong certain", "ambiguous with truth", "ambiguous without",
    "unexplained", "insufficient", "nothing missing", "crash",
)  # fmt: skip


def certain(verdict: dict) -> set[str]:
    """Causes that are shown and alone in their credible set."""
    causes = [one for one in verdict.get("causes", []) if one.get("shown")]
    return {one["mechanism"] for one in causes if len(one["credible_set"]) == 1}


def ambiguous(effects: list[str], verdict: dict) -> str:
    """Whether what is left as possible holds all that is hidden."""
    possible = set(verdict.get("possible") or {}) | certain(verdict)
    left = [(FAIR[one] or {OTHER}) & possible for one in effects]
    if not effects:
        left = [(verdict.get("probabilities") or {}).get("none", 0.0) > SEEN]
    return "ambiguous with truth" if all(left) else "ambiguous without"


def outcome(effects: list[str], verdict: dict) -> str:
    """One of `OUTCOMES`. A wrong certain name beside a right one is wrong."""
    answer, names = verdict["answer"], certain(verdict)
    if names - set().union(*(FAIR[one] for one in effects)):
        return "wrong certain"
    if answer == "named" and names:
        return "right certain" if all(FAIR[one] & names for one in effects) else "part right"
    if answer in ("named", "ambiguous"):
        return ambiguous(effects, verdict)
    return {"insufficient-data": "insufficient", "nothing-missing": "nothing missing"}.get(
        answer, answer
    )


def diagnosed(folder: Path) -> dict:
    """The verdict on a campaign's folder; an exception is an answer, too."""
    import bladeroot as br

    begun = time.perf_counter()
    try:
        said = dict(br.diagnose(folder).said)
    except Exception:
        said = {"answer": "crash", "reason": traceback.format_exc()}
    return said | {"wall_s": round(time.perf_counter() - begun, 1)}


def scored(seed: int, folder: Path, kind: str, effect: str) -> dict:
    """Draw, seal, write, diagnose, judge: a row of the results."""
    bench, verdict_file = Bench(seed, kind, effect), folder / f"verdict-{seed}.json"
    campaign = folder / f"c{seed}"
    if not verdict_file.is_file():
        shutil.rmtree(campaign, ignore_errors=True)
        (folder / f"truth-{seed}.json").write_text(json.dumps(bench.truth(), indent=1) + "\n")
        write_campaign(bench, campaign)
        verdict = diagnosed(campaign)
        verdict_file.write_text(json.dumps(verdict, indent=1, default=str) + "\n")
    verdict, effects = json.loads(verdict_file.read_text()), list(bench.effects)
    likely = sorted((verdict.get("probabilities") or {}).items(), key=lambda one: -one[1])[:3]
    return {
        "seed": seed, "kind": bench.kind, "model": bench.model, "effects": effects,
        "records": len(bench.visits), "answer": verdict["answer"],
        "outcome": outcome(effects, verdict), "certain": sorted(certain(verdict)),
        "likely": dict(likely), "wall_s": verdict["wall_s"],
    }  # fmt: skip


def line(row: dict) -> str:
    """A row in words."""
    hidden, names = "+".join(row["effects"]) or "-", ",".join(row["certain"]) or "-"
    likely = ", ".join(f"{name} {share:.2f}" for name, share in row["likely"].items())
    return (
        f"{row['seed']} {row['kind']} {row['model']} {row['records']} records, hidden {hidden}; "
        f"{row['answer']}: {names} -> {row['outcome']} ({likely}; {row['wall_s']:.0f} s)"
    )


def table(rows: list[dict]) -> str:
    """Outcomes by kind."""
    head = ["kind", "campaigns", *OUTCOMES]
    lines = [head, ["---"] * len(head)]
    for kind in KINDS:
        found = Counter(row["outcome"] for row in rows if row["kind"] == kind)
        lines.append([kind, str(found.total()), *(str(found[one] or "") for one in OUTCOMES)])
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def seeds_of(text: str) -> list[int]:
    """`3`, `1-40` or a list of both, split by commas."""
    ends = [part.partition("-") for part in text.split(",")]
    return [seed for a, _, b in ends for seed in range(int(a), int(b or a) + 1)]


def main() -> None:
    """Print a line for each campaign, and the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="1-10", help="as 1-40 or 3,7")
    parser.add_argument("--out", type=Path, help="folder that keeps campaigns, truths and verdicts")
    parser.add_argument("--kind", default="", choices=["", *KINDS])
    parser.add_argument("--effect", default="", choices=["", *FAIR], help="the one to hide")
    parser.add_argument("--json", type=Path, help="file that keeps the rows")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as passing:
        folder, rows = chosen.out or Path(passing), []
        folder.mkdir(parents=True, exist_ok=True)
        for seed in seeds_of(chosen.seeds):
            rows.append(scored(seed, folder, chosen.kind, chosen.effect))
            print(line(rows[-1]), flush=True)
    if chosen.json:
        chosen.json.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
    print(table(rows))


if __name__ == "__main__":
    main()
