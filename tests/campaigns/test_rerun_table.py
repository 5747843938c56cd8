"""Single changes of a finished house, and what each makes the next run do: a case a line.

A case's second column is what must be done again by itself, its third what also may; what stands on
them follows, as the house's own statements say. Nothing else may be done.
"""
# ruff: noqa: E501

import json
import os
import re
import shutil
import sys
import time
from collections import defaultdict
from pathlib import Path

import pytest
from house import House

LIBRARY = "workflow/bladeroot/"
SMALL = "resources/campaigns/small/"
TINY = "resources/structures/tiny.yaml"
CONFIG = "config/config.yaml"
RESULTS = "results/small/"
BENCH_FILES = "results/bench/small/"


# --- changes: each takes the house's folder


def put(path, old, new):
    """Another text in a file, saved now."""

    def change(folder):
        text = (folder / path).read_text()
        assert old in text, f"{path} has no {old!r}"
        (folder / path).write_text(text.replace(old, new, 1))

    return change


def put_older(path, old, new):
    """As `mv`, `cp -p`, `unzip` and `rsync` leave it: another content with a time of long ago."""

    def change(folder):
        put(path, old, new)(folder)
        os.utime(folder / path, (1e9, 1e9))

    return change


def moved_in(path, old, new):
    """A folder with another file in it takes the place of the folder: no time of a file changes."""

    def change(folder):
        place = (folder / path).parent
        other = place.with_name("another")
        shutil.copytree(place, other)
        put(str((other / Path(path).name).relative_to(folder)), old, new)(folder)
        os.utime(other / Path(path).name, (1e9, 1e9))
        shutil.move(place, place.with_name("before"))
        other.rename(place)
        shutil.rmtree(place.with_name("before"))

    return change


def code(path):
    return lambda folder: _append(folder / LIBRARY / path, "\n_changed = True\n")


def remark(path):
    return lambda folder: _append(folder / path, "\n# A remark.\n")


def _append(path, text):
    path.write_text(path.read_text() + text)


def new(path, text):
    return lambda folder: (folder / path).write_text(text)


def touched(pattern, seconds=None):
    """Other times, older than all or now, and the same content."""

    def change(folder):
        for path in folder.glob(pattern):
            os.utime(path, seconds and (seconds, seconds))

    return change


def gone(path):
    def change(folder):
        place = folder / path
        shutil.rmtree(place) if place.is_dir() else place.unlink()

    return change


def bytes_of(path, other):
    """Other bytes in a file, which keeps its times: a length of them, or those of another file."""

    def change(folder):
        place = folder / path
        kept = place.stat()
        content = place.read_bytes()
        place.write_bytes(
            (folder / other).read_bytes() if isinstance(other, str) else other(content)
        )
        os.utime(place, ns=(kept.st_atime_ns, kept.st_mtime_ns))

    return change


def column(name, value):
    """One more column in the sheet, the same in each row."""

    def change(folder):
        sheet = folder / SMALL / "records.csv"
        first, *rows = sheet.read_text().splitlines()
        sheet.write_text("\n".join([f"{first},{name}", *(f"{row},{value}" for row in rows)]) + "\n")

    return change


def rows(order):
    """The sheet's rows in another order, or fewer."""

    def change(folder):
        sheet = folder / SMALL / "records.csv"
        first, *lines = sheet.read_text().splitlines()
        sheet.write_text("\n".join([first, *order(lines)]) + "\n")

    return change


def both(*changes):
    def change(folder):
        for one in changes:
            one(folder)

    return change


NOTHING = ""
SHEET, CAMPAIGN, BENCH = SMALL + "records.csv", SMALL + "campaign.yaml", SMALL + "bench.yaml"
STEMS = "mesh prestress shapes reduced checks accuracy"
FORGET = gone(".snakemake")

QUICK = [
    ("nothing", lambda folder: None, NOTHING),
    ("lost .snakemake", FORGET, NOTHING),
    ("lost .snakemake, a setting", both(FORGET, put(CONFIG, "1B: 0.5", "1B: 0.4")), "search joint amplitude diagnosis"),
    ("structure, older time", put_older(TINY, "poisson_ratio: 0.3\n", "poisson_ratio: 0.31\n"), STEMS),
    ("structure, comment", put(TINY, "# x from", "# X from"), NOTHING),
    ("stick.nc altered, time kept", bytes_of(RESULTS + "stick.nc", lambda b: b + b"x"), "stick"),
    ("plateau empty", new(RESULTS + "plateau/r001.nc", ""), "ringdown"),
    ("all touched, sources", touched("resources/**/*.*"), NOTHING),
    ("all touched, results older", touched("results/**/*.nc", 1e9), NOTHING),
    ("code of cutting", code("decay/cut.py"), "ringdown"),
    ("column that the report alone may show", column("note_weather", "rain"), NOTHING, "report"),
]  # fmt: skip

TABLE = [
    # the sheet
    ("rows reversed", rows(lambda r: r[::-1]), NOTHING, "report"),
    ("blank line", put(SHEET, "\nr003", "\n\nr003"), NOTHING, "report"),
    ("spaces", put(SHEET, "r002,r002.nc,2B,", "r002 , r002.nc, 2B ,"), NOTHING, "report"),
    ("another note column", column("note", "a b"), NOTHING, "report"),
    ("sheet, older time", put_older(SHEET, "180,2.6", "180,2.7"), "bench ringdown"),
    ("drive", put(SHEET, "180,2.6", "180,2.7"), "bench ringdown"),
    ("time", put(SHEET, "h1,up,180", "h1,up,190"), "bench ringdown observations"),
    ("pressure", put(SHEET, "2B,60,h1", "2B,61,h1"), "bench ringdown"),
    ("direction", put(SHEET, "h1,up,180", "h1,down,180"), "bench ringdown"),
    ("start of a record", column("end_s", "0.5"), "ringdown", "bench"),
    ("row removed", rows(lambda r: r[:-1]), "ringdown bench score report curves integrity observations stick amplitude", "report"),
    ("record renamed", put(SHEET, "r006,r006.nc", "r996,r996.nc"), "ringdown bench", "report"),
    # the campaign's description
    ("title", put(CAMPAIGN, "title: A small", "title: Another small"), "report"),
    ("notes", put(CAMPAIGN, "notes: SIM", "notes: All SIM"), "report"),
    ("campaign, comment", put(CAMPAIGN, "title:", "# a remark\ntitle:"), NOTHING),
    ("campaign, order", put(CAMPAIGN, "expected_Hz: 540, laser_x_mm: 0", "laser_x_mm: 0, expected_Hz: 540"), NOTHING),
    ("campaign, older time", put_older(CAMPAIGN, "expected_Hz: 540", "expected_Hz: 541"), "ringdown diagnosis report"),
    ("expected frequency", put(CAMPAIGN, "expected_Hz: 540", "expected_Hz: 541"), "ringdown diagnosis report"),
    ("laser", put(CAMPAIGN, "laser_x_mm: -70", "laser_x_mm: -71"), "amplitude observations report", "ringdown"),
    ("gauge's accuracy", put(CAMPAIGN, "accuracy_percent: 1", "accuracy_percent: 2"), "fe_forces joint amplitude observations report", "ringdown bench"),
    ("gauge's piston", put(CAMPAIGN, "piston_area_cm2: 17.9", "piston_area_cm2: 18"), "ringdown report", "bench observations"),
    # the bench
    ("bench, comment", put(BENCH, "seed: 7", "seed: 7  # lucky"), NOTHING),
    ("bench, seed", put(BENCH, "seed: 7", "seed: 8"), "bench"),
    ("bench, older time", put_older(BENCH, "seed: 7", "seed: 8"), "bench"),
    ("bench, moved in", moved_in(BENCH, "seed: 7", "seed: 8"), "bench"),
    ("bench, friction", put(BENCH, "coefficient: 0.42", "coefficient: 0.43"), "bench"),
    ("bench, spaces", put(BENCH, "seed: 7", "seed:   7"), NOTHING),
    ("bench, order", put(BENCH, "seed: 7\nstructure: tiny", "structure: tiny\nseed: 7"), NOTHING),
    # the structure
    ("structure, layout", put(TINY, "    - [0, 5]", "    - [0,   5]"), NOTHING),
    ("structure, 0.3 as 0.30", put(TINY, "poisson_ratio: 0.3\n", "poisson_ratio: 0.30\n"), NOTHING),
    ("structure, density", put(TINY, "7592", "7593"), STEMS),
    ("structure, profile", put(TINY, "[139.68, 5]", "[139.7, 5]"), STEMS),
    ("structure, mesh", put(TINY, "root_element_mm: 12", "root_element_mm: 13"), STEMS),
    ("structure, moved in", moved_in(TINY, "7592", "7593"), STEMS),
    ("structure in the campaign's folder", both(lambda f: shutil.copy(f / TINY, f / SMALL)), NOTHING, STEMS),
    # the configuration
    ("search, bias", put(CONFIG, "1B: 0.5", "1B: 0.4"), "search joint amplitude diagnosis"),
    ("search, offset", put(CONFIG, "2B: 0.0", "2B: 0.1"), "search joint amplitude diagnosis"),
    ("search, swapped", put(CONFIG, "{1B: 0.5, 2B: 0.6}", "{1B: 0.6, 2B: 0.5}"), "search joint amplitude diagnosis"),
    ("search, order", put(CONFIG, "{1B: 0.5, 2B: 0.6}", "{2B: 0.6, 1B: 0.5}"), NOTHING),
    ("config, comment", put(CONFIG, "record:", "# a remark\nrecord:"), NOTHING),
    ("config, older time", put_older(CONFIG, "end: noise", "end: 0.2"), "ringdown"),
    ("estimator", put(CONFIG, "estimator: blocks", "estimator: thesis"), "ringdown"),
    ("damping", put(CONFIG, "damping: hysteretic", "damping: viscous"), "ringdown"),
    ("table error, of a table alone", put(CONFIG, "table_error: stated", "table_error: scatter"), "stick"),
    ("box of stiffness", put(CONFIG, "[0.1, 1000]", "[0.1, 900]"), "parametric"),
    ("box of forces", put(CONFIG, "force_kN: [0, 30]", "force_kN: [0, 31]"), "parametric"),
    ("a force more", put(CONFIG, "[12, 16]", "[12, 14, 16]"), "accuracy frequency_maps search fe_forces joint", "amplitude stiffness"),
    ("curves' discrepancy", put(CONFIG, "discrepancy_percent: 5", "discrepancy_percent: 6"), "amplitude"),
    ("nonlinear, on demand alone", put(CONFIG, "friction: 0.42", "friction: 0.43"), NOTHING, "report"),
    ("kept environment", put(CONFIG, "model:", "keep_environment: numpy 0\nmodel:"), STEMS + " parametric ringdown bench"),
    # code
    ("comment", remark(LIBRARY + "decay/freevib.py"), NOTHING),
    ("comment in a script", remark("workflow/scripts/stick.py"), NOTHING),
    ("script", put("workflow/scripts/stick.py", "def main(", "CHANGED = 1\n\n\ndef main("), "stick"),
    ("code, older time", both(code("decay/cut.py"), touched(LIBRARY + "decay/cut.py", 1e9)), "ringdown"),
    ("reader", code("io/readers/wav.py"), "ringdown stick"),
    ("new reader", new(LIBRARY + "io/readers/none.py", "SUFFIXES = ()\n"), "ringdown stick"),
    ("finding", code("quality/findings/clipping.py"), "ringdown", "integrity report diagnosis observations curves report"),
    ("shipped mechanism", code("mechanisms/drift.py"), "diagnosis", "report"),
    ("new mechanism's file", new(LIBRARY + "mechanisms/none.py", "NOTHING = 1\n"), "diagnosis", "report"),
    ("template", put(LIBRARY + "report/page.html.j2", "<", "<!-- x --><"), "report", "score"),
    ("style, older time", put_older(LIBRARY + "report/page.css", "{", " {"), "report", "score"),
    ("mesh", code("fem/mesh.py"), "mesh", "prestress shapes reduced checks accuracy"),
    ("shapes", code("fem/shapes.py"), "shapes"),
    ("greedy", code("rom/greedy.py"), "parametric"),
    ("reduction", code("rom/reduction.py"), "reduced", "mesh prestress shapes checks accuracy"),
    ("bench's tip", code("bench/tip.py"), "bench"),
    ("bench's stepping", code("bench/stepping.py"), "bench"),
    ("pff", code("decay/pff.py"), "ringdown"),
    ("spectra", code("decay/spectra.py"), "report"),
    ("pooled curves", code("pooling/curves.py"), "curves", "integrity"),
    ("interpolation", code("stiffness/interpolation.py"), "fe_forces", "joint amplitude diagnosis"),
    ("posterior", code("stiffness/posterior.py"), "joint amplitude", "diagnosis"),
    ("curve of a level", code("pooling/level_curve.py"), "curves integrity observations amplitude diagnosis"),
    ("theory", code("contact/theory.py"), "theory"),
    ("law of friction", code("contact/laws/iwan.py"), "amplitude shortfall"),
    ("verdict", code("diagnosis/verdict.py"), "diagnosis"),
    ("observations", code("diagnosis/observations.py"), "observations"),
    ("figure of sticks", code("figures/stick.py"), "report"),
    ("figure of theory", code("figures/theory.py"), "report"),
    ("figure of a joint", code("figures/joint.py"), "report"),
    ("page", code("report/page.py"), "report", "score"),
    ("schema", remark(LIBRARY + "schemas/bench.schema.yaml"), "bench"),
    ("a rule's comment", remark("workflow/rules/stick.smk"), NOTHING),
    ("a rule's command", put("workflow/rules/stick.smk", "stick.py --sources", "stick.py  --sources"), "stick"),
    ("own mechanism", both(lambda f: (f / "own").mkdir(exist_ok=True), new("own/a.py", "X = 1\n"), put(CONFIG, 'mechanisms: ""', "mechanisms: own")), "diagnosis"),
    # sources that a table gives
    ("printed table", put("resources/thesis/table_5_2.csv", "\n", "\n\n"), "stiffness theory"),
    ("printed table, older time", put_older("resources/thesis/table_5_2.csv", "\n", "\n\n"), "stiffness theory"),
    ("table of the checks", put_older("resources/thesis/table_4_2.csv", "\n", "\n\n"), "checks"),
    ("contact parameters", put_older("resources/thesis/contact_parameters.csv", "\n", "\n\n"), "theory"),
    ("errata, layout", put_older("resources/thesis/errata.yaml", "\n", "\n\n"), NOTHING),
    # times
    *((f"touched {name}", touched(pattern), NOTHING) for name, pattern in (
        ("structure", TINY), ("bench", BENCH), ("sheet", SHEET), ("config", CONFIG), ("library", LIBRARY + "**/*.py"),
        ("scripts", "workflow/scripts/*.py"), ("rules", "workflow/rules/*.smk"), ("mesh", "results/structures/tiny/mesh.nc"),
        ("raw", BENCH_FILES + "*.nc"), ("stick", RESULTS + "stick.nc"), ("drawing", "results/structures/tiny/modes.svg"),
        ("tables", "resources/thesis/*"), ("verdict", RESULTS + "diagnosis/*"), ("batches", RESULTS + "batches/*"))),
    *((f"older {name}", touched(pattern, 1e9), NOTHING) for name, pattern in (
        ("sources", "resources/**/*.*"), ("raw", BENCH_FILES + "*.nc"), ("report", RESULTS + "report.html"),
        ("mesh", "results/structures/tiny/mesh.nc"), ("everything", "**/*.*"))),
    ("a clock that is ahead", touched("resources/**/*.*", time.time() + 1e6), NOTHING),
    ("times of 1970", touched("**/*.*", 1.0), NOTHING),
    # artifacts and records
    *((f"{name} gone", gone(path), NOTHING, rule) for name, path, rule in (
        ("mesh", "results/structures/tiny/mesh.nc", "mesh"), ("a decay", RESULTS + "decay/r001.nc", "ringdown"),
        ("verdict", RESULTS + "diagnosis/verdict.json", "verdict"))),
    ("report gone", gone(RESULTS + "report.html"), "report"),
    *((f"{name} empty", new(path, ""), rule) for name, path, rule in (
        ("mesh", "results/structures/tiny/mesh.nc", "mesh"), ("stick", RESULTS + "stick.nc", "stick"),
        ("report", RESULTS + "report.html", "report"), ("batch", RESULTS + "batches/b.txt", "ringdown"),
        ("verdict", RESULTS + "diagnosis/verdict.json", "verdict"), ("model", RESULTS + "diagnosis/tiny.model.yaml", "diagnosis"))),
    *((f"{name} cut off", bytes_of(path, lambda b: b[: len(b) // 2]), rule) for name, path, rule in (
        ("raw", BENCH_FILES + "r001.nc", "bench"), ("curves", RESULTS + "curves.nc", "curves"),
        ("drawing", "results/structures/tiny/modes.svg", "shapes"), ("joint", RESULTS + "joint/tiny.nc", "joint"))),
    *((f"{name} replaced by another", bytes_of(path, other), rule) for name, path, other, rule in (
        ("raw", BENCH_FILES + "r001.nc", BENCH_FILES + "r002.nc", "bench"),
        ("decay", RESULTS + "decay/r001.nc", RESULTS + "decay/r002.nc", "ringdown"),
        ("map", "results/structures/tiny/map/12000.nc", "results/structures/tiny/map/16000.nc", "frequency_maps"))),
    ("statement gone", gone("results/provenance/stick/small.json"), "stick"),
    ("statement cut off", bytes_of("results/provenance/stick/small.json", lambda b: b[:40]), "stick"),
    ("all statements gone", gone("results/provenance"), "mesh checks bench ringdown"),
    ("contents forgotten", gone(".snakemake/bladeroot_contents.json"), NOTHING),
    ("contents damaged", new(".snakemake/bladeroot_contents.json", '{"a": 1'), NOTHING),
    ("logs and benchmarks gone", both(gone("results/logs"), gone("results/benchmarks")), NOTHING),
    ("a file of one's own", new(RESULTS + "notes.nc", "mine"), NOTHING),
    ("lost .snakemake, code", both(FORGET, code("decay/cut.py")), "ringdown"),
    ("lost .snakemake, older structure", both(FORGET, put_older(TINY, "7592", "7593")), STEMS),
    ("lost .snakemake, bench", both(FORGET, put_older(BENCH, "seed: 7", "seed: 8")), "bench"),
    ("lost .snakemake, all touched", both(FORGET, touched("**/*.*")), NOTHING),
]  # fmt: skip


# --- the planned jobs of a house, in a fork of this process: Snakemake is loaded once


def planned(folder):
    """Stages that the next run would do."""
    import snakemake.cli

    told = folder / "plan.txt"
    child = os.fork()
    if child == 0:
        try:
            _plan(folder, told, snakemake.cli)
        finally:
            os._exit(1)
    os.waitpid(child, 0)
    text = told.read_text()
    if "Nothing to be done" in text:
        return set()
    table = re.search(r"^job +count\n[- ]+\n(.*?)^total", text, re.MULTILINE | re.DOTALL)
    assert table, text[-3000:]
    return {line.split(".")[0].split()[0] for line in table[1].splitlines() if line} - {"all"}


def _plan(folder, told, cli):
    for name in [name for name in sys.modules if name.split(".")[0] == "bladeroot"]:
        del sys.modules[name]
    sys.path[:] = [one for one in sys.path if not one.startswith(str(Path(__file__).parents[2]))]
    os.chdir(folder)
    with told.open("w") as out:
        sys.stdout = sys.stderr = out
        cli.main(["-n", "-j1"])


@pytest.fixture
def untouched(house, tmp_path):
    """A copy of the finished house with its times, for one change."""
    copy = tmp_path / "house"
    shutil.copytree(house.folder, copy, symlinks=True, ignore=shutil.ignore_patterns("log"))
    return copy


def followers(folder):
    """Stages that read what a stage made, from the statements of a finished house."""
    made, reads = {}, defaultdict(set)
    stated = [
        json.loads(one.read_text()) for one in (folder / "results/provenance").rglob("*.json")
    ]
    stage = {id(one): one["rule"].split(".")[0] for one in stated}
    for one in stated:
        made |= dict.fromkeys(one["outputs"], stage[id(one)])
    for one in stated:
        for path in one["inputs"]:
            if path in made:
                reads[made[path]].add(stage[id(one)])
    return reads


def closed(stages, reads):
    waiting, found = list(stages), set(stages)
    while waiting:
        more = reads[waiting.pop()] - found
        found |= more
        waiting += more
    return found


# Plans by a copy of the library, whose classes checks of types take for others.
@pytest.mark.wrong_shape
@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=case[0], marks=[pytest.mark.slow] * (case in TABLE)) for case in QUICK + TABLE],
)  # fmt: skip
def test_what_a_change_redoes(case, house: House, untouched):
    _, change, must, *may = case
    reads = followers(house.folder)
    change(untouched)
    found = planned(untouched)
    least, most = (
        closed(set(names), reads) for names in (must.split(), " ".join([must, *may]).split())
    )
    assert least - found == set(), "stale"
    assert found - most == set(), "too much"
