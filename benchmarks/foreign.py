"""The product on sealed campaigns of a laboratory that it has never seen.

    python benchmarks/foreign.py run --seeds 1-40 --out DIR --shipped PARAMETRIC
    python benchmarks/foreign.py run --seeds 1-5 --effect joint-slip --out DIR ...
    python benchmarks/foreign.py curves --seeds 1-40 --out DIR --shipped PARAMETRIC    # quick tier
    python benchmarks/foreign.py loop --seeds 1-40 --out DIR --shipped PARAMETRIC      # to the end
    python benchmarks/foreign.py score --out DIR --rows FILE      # or --out FILE: the tables again
    python benchmarks/foreign.py tables                # kept results into the pages that show them
    python benchmarks/foreign.py make --seeds 7 --out DIR ...     # the campaign alone

PARAMETRIC is results/structures/dovetail-HB/parametric.nc of a run.

Seeds 1 to 9999 are for tuning; from 100000 on they are for scoring alone. A case whose verdict is
there is not run again unless `--again`; `--keep` keeps raw records and artifacts. With `--analysed`
records are analysed once, so that a changed diagnosis is tried within a second or two a case.
"""

import argparse
import json
import os
import shutil
import sys
import time
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import xarray as xr  # noqa: E402
from foreign_lab.case import Case, draw_case, opened, seal, write_campaign  # noqa: E402
from foreign_lab.jointed_beam import export  # noqa: E402
from foreign_lab.score import loop_report, outcome, report, row, with_table  # noqa: E402


def seeds_of(text: str) -> list[int]:
    """`3`, `1-40` or a list of both, split by commas."""
    found: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        found += range(int(first), int(last or first) + 1)
    return found


def drawn(args: argparse.Namespace, seed: int) -> Case:
    """The case of a seed, its specimen from the cache."""
    cache = args.cache or args.out / "cache"
    return draw_case(seed, cache, args.shipped, args.kind, args.effect)


def make(args: argparse.Namespace, raw: bool = True) -> None:
    """Campaigns with their sealed truths, no inference."""
    for seed in seeds_of(args.seeds):
        folder = args.out / "campaigns" / f"c{seed}"
        shutil.rmtree(folder, ignore_errors=True)
        case = drawn(args, seed)
        args.out.mkdir(parents=True, exist_ok=True)
        digest = seal(case, args.out / f"truth-{seed}.json")
        write_campaign(case, folder, raw)
        print(f"{folder}: {len(case.sheet.mode)} records, sealed {digest[:16]}")


def run(args: argparse.Namespace) -> None:
    """Make, seal, infer, open, tell."""
    from foreign_lab.run import analysed_file, infer

    for seed in seeds_of(args.seeds):
        answer = args.out / f"verdict-{seed}.json"
        if answer.is_file() and not args.again:
            continue
        begun = time.process_time()
        folder, results = args.out / "campaigns" / f"c{seed}", args.out / "results" / f"c{seed}"
        for old in (folder, results):
            shutil.rmtree(old, ignore_errors=True)
        store = (
            analysed_file(args.analysed, f"{seed}{args.kind}{args.effect}")
            if args.analysed
            else None
        )
        fresh = store is None or not store.is_file()
        make(argparse.Namespace(**(vars(args) | {"seeds": str(seed)})), raw=fresh)
        cache = args.cache or args.out / "cache"
        verdict = infer(folder, results, cache, args.shipped, args.keep, store)
        answer.write_text(json.dumps(verdict, indent=1) + "\n")
        spent = time.process_time() - begun
        _tell(opened(args.out / f"truth-{seed}.json"), verdict, spent)
        if not args.keep:
            shutil.rmtree(folder)
            shutil.rmtree(results, ignore_errors=True)


def curves(args: argparse.Namespace) -> None:
    """The quick tier: curves to verdict. Cases with a fault of the records are left out."""
    from foreign_lab.curves import observations, shows
    from foreign_lab.run import judge

    args.out.mkdir(parents=True, exist_ok=True)
    for seed in seeds_of(args.seeds):
        answer = args.out / f"verdict-{seed}.json"
        case = drawn(args, seed) if args.again or not answer.is_file() else None
        if case is None or not shows(case):
            continue
        seal(case, args.out / f"truth-{seed}.json")
        with xr.open_dataset(told(args, case)) as model:
            verdict = judge(observations(case, args.thermometer), model.load())
        answer.write_text(json.dumps(verdict, indent=1) + "\n")
        _tell(opened(args.out / f"truth-{seed}.json"), verdict, verdict["seconds"]["diagnosis"])


def loop(args: argparse.Namespace) -> None:
    """What a verdict asks for is carried out, at most twice, and the verdict made again, until it
    asks for nothing.
    """
    import numpy as np
    from foreign_lab.curves import observations, shows
    from foreign_lab.further import facts, with_records
    from foreign_lab.run import judge

    args.out.mkdir(parents=True, exist_ok=True)
    for seed in seeds_of(args.seeds):
        answer, case = args.out / f"loop-{seed}.json", drawn(args, seed)
        listed = case.effects and not any(one.outside for one in case.effects)
        if answer.is_file() or not listed or not shows(case):
            continue
        model, rng = xr.open_dataset(told(args, case)).load(), np.random.default_rng([seed, 7])
        known, steps = [], []
        seal(case, args.out / f"truth-{seed}.json")
        truth = opened(args.out / f"truth-{seed}.json")
        for _ in range(3):
            verdict = judge(observations(case), model, known)
            ended = outcome(truth, verdict)
            steps.append({"answer": verdict["answer"], "outcome": ended, "asked": ""})
            asked = next((one for one in verdict["next"] if one["hours"]), None)
            if not asked or len(steps) == 3:
                break
            steps[-1]["asked"] = asked["what"]
            if asked["load"] is None:
                known += facts(case, asked["measurement"], rng)
            else:
                case = with_records(
                    case, asked["measurement"], asked["load"], asked["clampings"], rng
                )
        answer.write_text(json.dumps(steps, indent=1) + "\n")
        hidden = ", ".join(f"{one['id']} ({one['form']})" for one in truth["effects"])
        said = " -> ".join(f"{one['outcome']} [{one['asked']}]" for one in steps)
        print(f"{seed}  hidden {hidden}; {said}", flush=True)


def told(args: argparse.Namespace, case: Case) -> Path:
    """The analyst's `parametric.nc`."""
    from foreign_lab.run import parametric_of

    if case.specimen.told is None:
        return args.shipped
    cache = args.cache or args.out / "cache"
    folder = cache / "drawings"
    drawing = folder / f"{case.specimen.name}.yaml"
    if not drawing.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        export(case.specimen.told, folder, case.specimen.name)
    return parametric_of(drawing, cache)


def _tell(truth: dict, verdict: dict, seconds: float) -> None:
    hidden = ", ".join(f"{one['id']} ({one['form']})" for one in truth["effects"]) or "nothing"
    causes = ", ".join("/".join(c["credible_set"]) for c in verdict["causes"]) or "-"
    print(
        f"{truth['seed']}  {seconds:.1f} s CPU; hidden {hidden}; "
        f"{verdict['answer']}: {causes} -> {outcome(truth, verdict)}",
        flush=True,
    )


def score(args: argparse.Namespace) -> None:
    """Tables of all verdicts, or loops, of a folder, or of the rows that `--rows` kept."""
    chosen = seeds_of(args.seeds) if args.seeds else None
    rows = []
    if args.out.is_file():
        rows = json.loads(args.out.read_text())
    else:
        kind = "loop" if any(args.out.glob("loop-*.json")) else "verdict"
        paths = {int(p.stem.removeprefix(f"{kind}-")): p for p in args.out.glob(f"{kind}-*.json")}
        for seed in sorted(paths.keys() & set(chosen) if chosen else paths):
            truth, said = (
                opened(args.out / f"truth-{seed}.json"),
                json.loads(paths[seed].read_text()),
            )
            hidden = [[one["id"], one["form"]] for one in truth["effects"]]
            rows.append(
                {"seed": seed, "hidden": hidden, "steps": said}
                if kind == "loop"
                else row(truth, said)
            )
    if args.rows:
        args.rows.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
    print(loop_report(rows) if rows and "steps" in rows[0] else report(rows))


# Pages with tables of the results that are kept: page, name of its marks, file, brief.
TABLES = (
    ("benchmarks/README.md", "foreign raw", "foreign_raw.json", True),
    ("benchmarks/README.md", "foreign loop", "foreign_loop.json", True),
    ("docs/blind.md", "foreign curves", "foreign_curves.json", True),
)


def tabled() -> dict[Path, str]:
    """The pages of `TABLES` as the kept results make them."""
    here = Path(__file__).resolve().parent
    pages: dict[Path, str] = {}
    for page, name, file, brief in TABLES:
        rows, path = json.loads((here / file).read_text()), here.parent / page
        table = (loop_report if "steps" in rows[0] else report)(rows, brief)
        pages[path] = with_table(pages.get(path) or path.read_text(), name, table)
    return pages


def tables(_: argparse.Namespace) -> None:
    """The kept results into the pages that show them."""
    for path, text in tabled().items():
        path.write_text(text)


WHAT = {
    "make": make, "run": run, "curves": curves, "loop": loop, "score": score, "tables": tables
}  # fmt: skip


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=sorted(WHAT))
    parser.add_argument("--seeds", default="", help="as 1-40 or 3,7")
    parser.add_argument("--out", type=Path, help="folder of truths and verdicts")
    parser.add_argument("--cache", type=Path, help="folder of specimens, by default within --out")
    parser.add_argument("--shipped", type=Path, help="parametric.nc of dovetail-HB")
    parser.add_argument("--analysed", type=Path, help="folder that keeps the analysed records")
    parser.add_argument("--kind", default="", choices=["", "null", "single", "pair", "outside"])
    parser.add_argument("--effect", default="", help="the id of the one effect to hide")
    parser.add_argument("--thermometer", action="store_true", help="curves: with temperatures")
    parser.add_argument("--rows", type=Path, help="score: file that keeps what tables are made of")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--keep", action="store_true")
    args = parser.parse_args()
    if args.out is None and args.what != "tables":
        parser.error("--out is needed")
    WHAT[args.what](args)


if __name__ == "__main__":
    main()
