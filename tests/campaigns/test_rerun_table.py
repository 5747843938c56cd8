"""Single changes of a finished house, and what each makes the next run do: a case a line.

A case's third part is what must be done again by itself, its fourth what also may; what stands on
them follows, as the house's own statements say. Nothing else may be done. Changes that redo nothing
are made together, a run a group; where a group redoes something, each is tried alone and named.
"""
# ruff: noqa: E501

import json
import os
import shutil
import time
from base64 import urlsafe_b64encode
from collections import Counter, defaultdict
from pathlib import Path

import pytest

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
    def change(folder):
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_text(text)

    return change


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


def moved(name):
    """The checkout stands elsewhere; its old place leads there, where the test looks for it."""

    def change(folder):
        folder.rename(folder.with_name(name))
        folder.symlink_to(name)

    return change


def exchanged(one, other):
    """Two files change places; their times go with them."""

    def change(folder):
        (folder / one).rename(folder / "between")
        (folder / other).rename(folder / one)
        (folder / "between").rename(folder / other)

    return change


def linked(path, old=None, new=None):
    """The file is a link to one elsewhere, which then says something else if that is given."""

    def change(folder):
        place, target = folder / path, folder / "no" / Path(path).name
        place.rename(target)
        place.symlink_to(target)
        if old is not None:
            put_older(str(target.relative_to(folder)), old, new)(folder)

    return change


def other_ends(pattern, mark=b""):
    """As editors and git leave texts on Windows."""

    def change(folder):
        for path in folder.glob(pattern):
            path.write_bytes(mark + path.read_bytes().replace(b"\n", b"\r\n"))

    return change


def hard_links(path):
    """Each file has a second name elsewhere, as in a backup of hard links."""
    return lambda folder: shutil.copytree(
        folder / path, folder / "backup", copy_function=os.link, symlinks=True
    )


NOTHING = ""
MARK = b"\xef\xbb\xbf"
SHEET, CAMPAIGN, BENCH = SMALL + "records.csv", SMALL + "campaign.yaml", SMALL + "bench.yaml"
STEMS = "shapes reduced checks accuracy"
FORGET = gone(".snakemake")

# Groups of changes that redo nothing: what they may redo all the same, and the changes by name.
HARMLESS = {
    "what says the same": (NOTHING, {
        "campaign, comment": put(CAMPAIGN, "title:", "# a remark\ntitle:"),
        "campaign, order of keys": put(CAMPAIGN, "expected_Hz: 540, laser_x_mm: 0", "laser_x_mm: 0, expected_Hz: 540"),
        "configuration, comment": put(CONFIG, "record:", "# a remark\nrecord:"),
        "configuration, order of keys": put(CONFIG, "{1B: 0.5, 2B: 0.6}", "{2B: 0.6, 1B: 0.5}"),
        "bench, layout and comment": put(BENCH, "seed: 7\nstructure: tiny", "structure: tiny\nseed:   7  # lucky"),
        "structure, comment": put(TINY, "# x from", "# X from"),
        "structure, layout": put(TINY, "    - [0, 5]", "    - [0,   5]"),
        "structure, another form of a number": put(TINY, "poisson_ratio: 0.3\n", "poisson_ratio: 0.30\n"),
        "code, comment": remark(LIBRARY + "decay/freevib.py"),
        "code, docstring": put(LIBRARY + "decay/cut.py", '"""', '"""Again: '),
        "script, comment": remark("workflow/scripts/stick.py"),
        "rule, comment": remark("workflow/rules/stick.smk"),
        "rule, memory of its jobs": put("workflow/rules/resources.smk", "(1400, 20, 0, 0)", "(1500, 20, 0, 0)"),
        "profile, comment": remark("profiles/default/config.yaml"),
        "errata of the thesis, which the campaign does not state": put_older("resources/thesis/errata.yaml", "\n", "\n\n"),
        "Table 5.2, which the campaign does not state": put_older("resources/thesis/table_5_2.csv", "\n", "\n\n"),
        "campaign, another system's line ends": other_ends(CAMPAIGN),
        "configuration, another system's line ends": other_ends(CONFIG),
        "structure, another system's line ends and mark": other_ends(TINY, MARK),
        "code, another system's line ends": other_ends(LIBRARY + "decay/*.py"),
        "code is a link to the same": linked(LIBRARY + "quality/peak_fit.py"),
        "bytecode gone": gone(LIBRARY + "decay/__pycache__"),
        "results have second names": hard_links("results"),
        "logs gone": gone("results/logs"),
        "benchmarks gone": gone("results/benchmarks"),
        "a file of mine among results": new(RESULTS + "notes.nc", "mine"),
        "lost .snakemake": FORGET,
    }),
    "columns that nobody reads": ("report", {
        "a column of notes": column("note", "a b"),
        "a column of another's": column("note_weather", "rain"),
        "rows in another order": rows(lambda r: r[::-1]),
        "another system's line ends and mark": other_ends(SHEET, MARK),
        "a blank row": put(SHEET, "\nr003", "\n\nr003"),
        "blanks beside cells": put(SHEET, "r002,r002.nc,2B,", "r002 , r002.nc, 2B ,"),
        "a setting of a stage on demand: friction": put(CONFIG, "friction: 0.42", "friction: 0.43"),
        "a setting of a stage on demand: strips": put(CONFIG, "strips: 8", "strips: 9"),
        "a setting of a stage on demand: harmonics": put(CONFIG, "[0, 1, 2, 3]", "[0, 1, 2, 3, 4]"),
    }),
    "times of now": (NOTHING, {
        "contents forgotten": new(".snakemake/bladeroot_contents.json", "{}"),
        **{f"touched, {path}": touched(path) for path in (
            TINY, BENCH, SHEET, CAMPAIGN, CONFIG, LIBRARY + "**/*.py", "workflow/scripts/*.py", "workflow/rules/*.smk",
            "resources/thesis/*", "results/structures/tiny/mesh.nc", "results/structures/tiny/modes.svg",
            BENCH_FILES + "*.nc", RESULTS + "stick.nc", RESULTS + "diagnosis/*", RESULTS + "batches/*", RESULTS + "report.html")},
    }),
    "older times": (NOTHING, {
        "contents damaged": new(".snakemake/bladeroot_contents.json", '{"a": 1'),
        **{f"older, {path}": touched(path, 1e9) for path in (
            BENCH_FILES + "*.nc", RESULTS + "report.html", RESULTS + "**/*.nc", "results/structures/tiny/mesh.nc",
            "resources/structures/*", SMALL + "*", "resources/thesis/*", LIBRARY + "**/*.py")},
    }),
    "clocks that are wrong": (NOTHING, {
        f"ahead, {path}": touched(path, time.time() + 1e6) for path in (
            "resources/structures/*", SMALL + "*", LIBRARY + "*.py", RESULTS + "**/*.nc", "results/provenance/**/*")
    }),
    "another place and 1970": (NOTHING, {
        "times of 1970": touched("**/*.*", 1.0),
        "checkout moved, under a name with a blank": moved("another place"),
    }),
    "what is between is gone": ("reduced ringdown verdict", {
        "mesh gone": gone("results/structures/tiny/mesh.nc"),
        "a decay gone": gone(RESULTS + "decay/r001.nc"),
        "verdict gone": gone(RESULTS + "diagnosis/verdict.json"),
    }),
    "lost metadata": (NOTHING, {
        "lost .snakemake, of all sources new times": both(FORGET, touched("**/*.*")),
        "checkout renamed": moved("renamed"),
    }),
}  # fmt: skip

RECORD = urlsafe_b64encode(f"{RESULTS}stick.nc".encode()).decode()
NUMPY = "Metadata-Version: 2.1\nName: numpy\nVersion: 9.9.9\n"
TABLE = [
    ("nothing", lambda folder: None, NOTHING),
    ("lost .snakemake, a setting", both(FORGET, put(CONFIG, "1B: 0.5", "1B: 0.4")), "search joint amplitude diagnosis"),
    ("structure, older time", put_older(TINY, "poisson_ratio: 0.3\n", "poisson_ratio: 0.31\n"), STEMS),
    ("stick.nc altered, time kept", bytes_of(RESULTS + "stick.nc", lambda b: b + b"x"), "stick"),
    ("plateau empty", new(RESULTS + "plateau/r001.nc", ""), "ringdown"),
    ("prior of a mechanism", put(LIBRARY + "mechanisms/drift.py", "2e-3, 1.0", "3e-3, 1.0"), "diagnosis"),
    ("code of cutting", code("decay/cut.py"), "ringdown"),
    # the sheet, the description, the bench, the structure, settings, libraries, code
    ("drive of a record", put(SHEET, "180,2.6", "180,2.8"), "bench ringdown"),
    ("mode's frequency", put(CAMPAIGN, "expected_Hz: 1450", "expected_Hz: 1451"), "ringdown diagnosis report"),
    ("bench, friction", put(BENCH, "coefficient: 0.42", "coefficient: 0.43"), "bench"),
    ("bench, noise", put(BENCH, "8.0e-6", "9.0e-6"), "bench"),
    ("structure, modulus, older time", put_older(TINY, "poisson_ratio: 0.3\n", "poisson_ratio: 0.29\n"), STEMS),
    ("model's bias of a mode", put(CONFIG, "2B: 0.6", "2B: 0.7"), "search joint amplitude diagnosis"),
    ("another numpy", new("no/numpy-9.9.9.dist-info/METADATA", NUMPY), STEMS + " parametric ringdown bench"),
    ("prior of kn and kt", code("stiffness/priors.py"), "joint amplitude diagnosis", "search fe_forces"),
    ("threshold of a name", code("diagnosis/guards.py"), "diagnosis"),
    ("callee of a compiled function", code("signal/banded.py"), "ringdown"),
    ("script of the page", put(LIBRARY + "report/page.js", "strict", "Strict"), "report", "score"),
    ("sheet, older time", put_older(SHEET, "180,2.6", "180,2.7"), "bench ringdown"),
    ("time", put(SHEET, "h1,up,180", "h1,up,190"), "bench ringdown observations"),
    ("pressure", put(SHEET, "2B,60,h1", "2B,61,h1"), "bench ringdown"),
    ("direction", put(SHEET, "h1,up,180", "h1,down,180"), "bench ringdown"),
    ("start of a record", column("end_s", "0.5"), "ringdown", "bench"),
    ("response of the sensor", column("response", "high-pass 0.5 Hz"), "ringdown", "bench"),
    ("row removed", rows(lambda r: r[:-1]), "ringdown bench score report curves integrity observations stick amplitude", "report"),
    ("record renamed", put(SHEET, "r006,r006.nc", "r996,r996.nc"), "ringdown bench", "report"),
    # the campaign's description
    ("title", put(CAMPAIGN, "title: A small", "title: Another small"), "report"),
    ("notes", put(CAMPAIGN, "notes: SIM", "notes: All SIM"), "report"),
    ("campaign, older time", put_older(CAMPAIGN, "expected_Hz: 540", "expected_Hz: 541"), "ringdown diagnosis report"),
    ("laser", put(CAMPAIGN, "laser_x_mm: -70", "laser_x_mm: -71"), "amplitude observations report", "ringdown"),
    ("gauge's accuracy", put(CAMPAIGN, "accuracy_percent: 1", "accuracy_percent: 2"), "fe_forces joint amplitude observations report", "ringdown bench"),
    ("gauge's piston", put(CAMPAIGN, "piston_area_cm2: 17.9", "piston_area_cm2: 18"), "ringdown report", "bench observations"),
    # the bench
    ("bench, older time", put_older(BENCH, "seed: 7", "seed: 8"), "bench"),
    ("bench, moved in", moved_in(BENCH, "seed: 7", "seed: 8"), "bench"),
    # the structure
    ("structure, density", put(TINY, "7592", "7593"), STEMS),
    ("structure, moved in", moved_in(TINY, "7592", "7593"), STEMS),
    ("structure in the campaign's folder", both(lambda f: shutil.copy(f / TINY, f / SMALL)), NOTHING, STEMS),
    # the configuration
    ("search, offset", put(CONFIG, "2B: 0.0", "2B: 0.1"), "search joint amplitude diagnosis"),
    ("search, swapped", put(CONFIG, "{1B: 0.5, 2B: 0.6}", "{1B: 0.6, 2B: 0.5}"), "search joint amplitude diagnosis"),
    ("config, older time", put_older(CONFIG, "end: noise", "end: 0.2"), "ringdown"),
    ("estimator", put(CONFIG, "estimator: blocks", "estimator: thesis"), "ringdown"),
    ("damping", put(CONFIG, "damping: hysteretic", "damping: viscous"), "ringdown"),
    ("table error, of a table alone", put(CONFIG, "table_error: stated", "table_error: scatter"), "stick"),
    ("box of stiffness", put(CONFIG, "[0.1, 1000]", "[0.1, 900]"), "parametric"),
    ("box of forces", put(CONFIG, "force_kN: [0, 30]", "force_kN: [0, 31]"), "parametric"),
    ("a force more", put(CONFIG, "[12, 16]", "[12, 14, 16]"), "accuracy frequency_maps search fe_forces joint", "amplitude stiffness"),
    ("curves' discrepancy", put(CONFIG, "discrepancy_percent: 5", "discrepancy_percent: 6"), "amplitude"),
    ("kept environment", put(CONFIG, "model:", "keep_environment: numpy 0\nmodel:"), STEMS + " parametric ringdown bench"),
    # code
    ("script", put("workflow/scripts/stick.py", "def main(", "CHANGED = 1\n\n\ndef main("), "stick"),
    ("code, older time", both(code("decay/cut.py"), touched(LIBRARY + "decay/cut.py", 1e9)), "ringdown"),
    ("new reader", new(LIBRARY + "io/readers/none.py", "SUFFIXES = ()\n"), "ringdown stick"),
    ("finding", code("quality/findings/clipping.py"), "ringdown", "integrity report diagnosis observations curves report"),
    ("new mechanism's file", new(LIBRARY + "mechanisms/none.py", "NOTHING = 1\n"), "diagnosis", "report"),
    ("template", put(LIBRARY + "report/page.html.j2", "<", "<!-- x --><"), "report", "score"),
    ("style, older time", put_older(LIBRARY + "report/page.css", "{", " {"), "report", "score"),
    ("mesh", code("fem/mesh.py"), "reduced", "shapes checks accuracy"),
    ("shapes", code("fem/shapes.py"), "shapes"),
    ("greedy", code("rom/greedy.py"), "parametric"),
    ("reduction", code("rom/reduction.py"), "reduced", "shapes checks accuracy"),
    ("bench's stepping", code("bench/stepping.py"), "bench"),
    ("pff", code("quality/peak_fit.py"), "ringdown"),
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
    ("schema", remark(LIBRARY + "schemas/bench.schema.yaml"), "bench"),
    ("a rule's command", put("workflow/rules/stick.smk", "stick.py --sources", "stick.py  --sources"), "stick"),
    ("own mechanism", both(lambda f: (f / "own").mkdir(exist_ok=True), new("own/a.py", "X = 1\n"), put(CONFIG, 'mechanisms: ""', "mechanisms: own")), "diagnosis"),
    # sources that a table gives
    ("tables of the thesis beside it", put(CAMPAIGN, "title:", "published: thesis\ntitle:"), "stiffness theory report slider ledger parametric_equal_nodes thesis_search"),
    ("table of the checks", put_older("resources/thesis/table_4_2.csv", "\n", "\n\n"), "checks"),
    ("contact parameters", put_older("resources/structures/flank.csv", "\n", "\n\n"), "theory"),
    # artifacts and records
    ("report gone", gone(RESULTS + "report.html"), "report"),
    *((f"{name} empty", new(path, ""), rule) for name, path, rule in (
        ("mesh", "results/structures/tiny/mesh.nc", "reduced"), ("report", RESULTS + "report.html", "report"), ("batch", RESULTS + "batches/b.txt", "ringdown"),
        ("model", RESULTS + "diagnosis/tiny.model.yaml", "diagnosis"))),
    *((f"{name} cut off", bytes_of(path, lambda b: b[: len(b) // 2]), rule) for name, path, rule in (
        ("raw", BENCH_FILES + "r001.nc", "bench"),
        ("drawing", "results/structures/tiny/modes.svg", "shapes"))),
    *((f"{name} replaced by another", bytes_of(path, other), rule) for name, path, other, rule in (
        ("raw", BENCH_FILES + "r001.nc", BENCH_FILES + "r002.nc", "bench"),
        ("map", "results/structures/tiny/map/12000.nc", "results/structures/tiny/map/16000.nc", "frequency_maps"))),
    ("statement gone", gone("results/provenance/stick/small.json"), "stick"),
    ("statement cut off", bytes_of("results/provenance/stick/small.json", lambda b: b[:40]), "stick"),
    ("all statements gone", gone("results/provenance"), "reduced checks bench ringdown"),
    ("decays exchanged", exchanged(RESULTS + "decay/r001.nc", RESULTS + "decay/r002.nc"), "ringdown"),
    ("raw records exchanged", exchanged(BENCH_FILES + "r001.nc", BENCH_FILES + "r002.nc"), "bench"),
    ("plateau of another record", lambda f: shutil.copy2(f / RESULTS / "plateau/r001.nc", f / RESULTS / "plateau/r003.nc"), "ringdown"),
    ("statements exchanged", exchanged("results/provenance/stick/small.json", "results/provenance/curves/small.json"), NOTHING),
    ("record of settings gone", gone(f"results/provenance/snakemake/{RECORD}"), "stick"),
    ("records of settings gone, a setting", both(gone("results/provenance/snakemake"), put(CONFIG, "1B: 0.5", "1B: 0.4")), "reduced checks bench ringdown", "report"),
    ("code of the same size and time", bytes_of(LIBRARY + "mechanisms/drift.py", lambda b: b.replace(b"2e-3, 1.0", b"3e-3, 1.0")), "diagnosis"),
    ("code that a link leads to, older time", linked(LIBRARY + "mechanisms/drift.py", "2e-3, 1.0", "3e-3, 1.0"), "diagnosis"),
    ("structure that a link leads to, older time", linked(TINY, "7592", "7593"), STEMS),
    ("unit of a variable, older time", put_older(LIBRARY + "contact/variables.csv", "1,", "m,"), "theory", "amplitude shortfall diagnosis bench report search fe_forces joint stiffness"),
    ("an older scipy", new("no/scipy-0.0.1.dist-info/METADATA", NUMPY.replace("numpy", "scipy").replace("9.9.9", "0.0.1")), STEMS + " parametric ringdown bench"),
    ("lost .snakemake, code", both(FORGET, code("decay/cut.py")), "ringdown"),
    ("lost .snakemake, older structure", both(FORGET, put_older(TINY, "7592", "7593")), STEMS),
]  # fmt: skip


def check(case, house, copy, *targets, beyond=frozenset()):
    """Make a case's change in a copy of a finished house, and look at what is planned then.

    beyond: stages that the targets do not stand on.
    """
    _, change, must, *may = case
    reads = followers(house.folder)
    change(copy.folder)
    found = set(copy.planned(*targets))
    least, most = (
        closed(set(names), reads) for names in (must.split(), " ".join([must, *may]).split())
    )
    assert least - found - beyond == set(), "stale"
    assert found - most == set(), "too much"


def check_harmless(group, house, place, *targets):
    """Make a group's changes together; where that redoes too much, name those that do so alone."""
    may, changes = group
    together = ("all", both(*changes.values()), NOTHING, may)
    try:
        check(together, house, house.copied(place / "together"), *targets)
    except AssertionError:
        guilty = []
        for number, (name, change) in enumerate(changes.items()):
            try:
                check(
                    (name, change, NOTHING, may), house, house.copied(place / str(number)), *targets
                )
            except AssertionError as error:
                guilty.append(f"{name}: {error}")
        raise AssertionError("; ".join(guilty) or "only together") from None


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


@pytest.mark.parametrize("case", TABLE, ids=lambda case: case[0])
def test_what_a_change_redoes(case, house, untouched):
    check(case, house, untouched)


@pytest.mark.parametrize("group", HARMLESS)
def test_what_redoes_nothing(group, house, tmp_path):
    check_harmless(HARMLESS[group], house, tmp_path)


def test_the_table_is_of_so_many_changes():
    """Each by its name; the table of faults counts groups, not what is in them."""
    grouped = [one for _, changes in (*HARMLESS.values(), OWN_HARMLESS) for one in changes]
    alone = [case[0] for rows in (TABLE, MODEL_TABLE) for case in rows]
    assert (len(alone), len(grouped)) == COUNTED
    assert len(set(alone)) + len(set(grouped)) > 130


AGAIN = (
    "bench ringdown stick fe_forces search stiffness joint amplitude theory score curves integrity "
    "observations diagnosis verdict report"
)


def test_an_added_record_redoes_its_batch_and_what_aggregates_it(untouched):
    """Wherever it stands in the sheet, it moves no other."""
    sheet = untouched.folder / SHEET
    lines = sheet.read_text().splitlines()
    added = ["r900", "r900.nc", *lines[1].split(",")[2:]]
    sheet.write_text("\n".join([*lines[:2], ",".join(added), *lines[2:]]) + "\n")
    assert untouched.planned() == Counter(AGAIN.split())


def test_a_batch_keeps_the_records_that_are_current(untouched):
    """A new record, one that is cut elsewhere and one whose result was altered are made; no other."""
    sheet, results = untouched.folder / SHEET, untouched.folder / "results"
    head, *lines = sheet.read_text().splitlines()
    fields = [
        head + ",end_s",
        *(line + "," for line in lines),
        lines[0].replace("r001", "r900") + ",",
    ]
    sheet.write_text("\n".join(fields).replace(",2.6,", ",2.6,0.5") + "\n")
    folders = [results / "small" / stage for stage in ("records", "decay", "plateau")]
    before = {
        path: (path.stat().st_ino, path.read_bytes())
        for one in folders
        for path in one.glob("*.nc")
    }
    altered = results / "small" / "decay" / "r003.nc"
    altered.write_bytes(b"other")
    untouched.run("--until", "ringdown.small.b")
    assert all((folder / "r900.nc").is_file() for folder in folders)
    again = {path for path, (inode, _) in before.items() if path.stat().st_ino != inode}
    assert again == {folder / f"{name}.nc" for folder in folders for name in ("r002", "r003")}
    for path, (_, content) in before.items():
        assert (path.read_bytes() == content) == (path.stem != "r002")
    assert not list((untouched.folder / ".snakemake" / "backups").rglob("*.nc"))
    assert untouched.planned()["ringdown"] == untouched.planned()["bench"] == 0


# --- a model file with a mechanism of one's own, which imports a neighbour and reads a table

OWN = """import numpy as np
from pathlib import Path
from bladeroot.mechanisms.mechanism import Mechanism, Parameter, StickEffect
from laws import scale

SIZE = Parameter("size", "1", 0.0, float(Path(__file__).with_name("prior.txt").read_text()),
                 -1.0, 1.0, "made up")


def stick(records, values):
    slope = scale(records.force)[:, None]
    return StickEffect(changes={"ln_f": slope[:, 0] * values[0]}, slopes={"ln_f": slope})


MECHANISM = Mechanism("wire", "level", "a wire pulls", (SIZE,), "cut it", stick=stick)
"""
MODEL = """schema: bladeroot-extension-1
campaign: small
structure: tiny
contact: {}
mechanisms:
- {mechanism: wire, parameters: {size: {value: 0.0001, std: 0.0001, unit: '1'}}}
"""
EXTENDED = [f"{RESULTS}extended/tiny/{name}.nc" for name in ("joint", "parametric")]
EXTENDED.append(f"{RESULTS}diagnosis/tiny.json")
ALL_OWN = "diagnosis extended_structure extended_joint"
OF_MODEL = "extended_structure extended_joint"
MODEL_TABLE = [
    ("mechanism", put("own/wire.py", "values[0]", "2 * values[0]"), ALL_OWN),
    ("mechanism, older time", put_older("own/wire.py", "values[0]", "2 * values[0]"), ALL_OWN),
    ("neighbour", put("no/laws.py", "1e4", "2e4"), ALL_OWN),
    ("neighbour, older time", put_older("no/laws.py", "1e4", "2e4"), ALL_OWN),
    ("neighbour, lost .snakemake", both(FORGET, put("no/laws.py", "1e4", "2e4")), ALL_OWN),
    ("neighbour's neighbour", put("no/lib/units.py", "KILO = 1e3", "KILO = 2e3"), ALL_OWN),
    ("table that it reads", put("own/prior.txt", "1", "2"), ALL_OWN),
    ("table that it reads, older time", put_older("own/prior.txt", "1", "2"), ALL_OWN),
    ("another mechanism", new("own/another.py", OWN.replace('"wire"', '"rope"')), ALL_OWN),
    ("mechanism renamed", put("own/wire.py", '"wire"', '"rope"'), ALL_OWN),
    ("shipped mechanism", code("mechanisms/drift.py"), ALL_OWN),
    ("model, value", put("own.model.yaml", "value: 0.0001", "value: 0.0002"), OF_MODEL),
    ("model, older time", put_older("own.model.yaml", "value: 0.0001", "value: 0.0002"), OF_MODEL),
    ("model of another place", both(lambda f: shutil.copy(f / "own.model.yaml", f / "b.yaml"), put(CONFIG, "own.model", "b")), OF_MODEL),
    ("extended joint altered", bytes_of(EXTENDED[0], lambda b: b + b"x"), "extended_joint"),
    ("priors of the search", put(CONFIG, "1B: 0.5", "1B: 0.4"), "extended_joint diagnosis", "search joint amplitude"),
]  # fmt: skip

OWN_HARMLESS = ("diagnosis", {
    "nothing": lambda folder: None,
    "mechanism, comment": remark("own/wire.py"),
    "mechanism touched": touched("own/*"),
    "a file that nobody reads": new("own/notes.txt", "mine"),
    "model, comment": remark("own.model.yaml"),
    "model touched": touched("own.model.yaml"),
})  # fmt: skip
COUNTED = (118, 80)  # changes of a run each, changes made together


@pytest.fixture(scope="module")
def extended(house, tmp_path_factory):
    """A house that has run with a mechanism of its own, and a model file that names it."""
    made = house.copied(tmp_path_factory.mktemp("extended") / "house")
    (made.folder / "own").mkdir()
    (made.folder / "no" / "lib").mkdir()
    new("own/wire.py", OWN)(made.folder)
    new("own/prior.txt", "1e-3")(made.folder)
    laws = "from lib.units import KILO\n\n\ndef scale(force):\n    return force / (1e4 * KILO)\n"
    new("no/laws.py", laws)(made.folder)
    new("no/lib/units.py", "KILO = 1e3\n")(made.folder)
    new("own.model.yaml", MODEL)(made.folder)
    made.edit(CONFIG, 'model: ""', "model: own.model.yaml")
    made.edit(CONFIG, 'mechanisms: ""', "mechanisms: own")
    made.run(*EXTENDED)
    return made


@pytest.mark.parametrize("case", MODEL_TABLE, ids=lambda case: case[0])
def test_what_a_change_of_an_extended_model_redoes(case, extended, tmp_path):
    check(
        case, extended, extended.copied(tmp_path / "copy"), *EXTENDED, beyond={"verdict", "report"}
    )


def test_what_redoes_nothing_of_an_extended_model(extended, tmp_path):
    check_harmless(OWN_HARMLESS, extended, tmp_path, *EXTENDED)
