"""Results that were copied by halves, replaced, linked, aged, or shared: one command.

Each case changes a finished folder of the tiny workflow. The same command must then end with the
results of the raw files as they are, redo nothing that was right (`again` says what it does), and
leave nothing to do; or say in one line what is wrong (`told`), and do nothing.
"""
# ruff: noqa: E501

import fcntl
import json
import os
import re
import resource
import shutil
import stat
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import pytest

A, B = "results/one/a.nc", "results/one/b.nc"
STATED, TWICE = "results/provenance/large/one.json", "results/provenance/twice/one.json"
RECORDS = "results/provenance/snakemake"
FUTURE, OLD = 4e9, 1e9


@pytest.fixture(scope="module")
def tiny():
    # loads Snakemake, which takes a second
    import tiny_workflow

    return tiny_workflow


@pytest.fixture(scope="module")
def finished(tiny, tmp_path_factory):
    folder = tiny.make(tmp_path_factory.mktemp("tiny") / "house")
    status, said = tiny.run(folder)
    assert status == 0, said
    return folder


# --- changes: each takes the folder


def write(path, text, seconds=None):
    def change(folder):
        place = folder / path
        kept = place.stat() if place.exists() else None
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(text if isinstance(text, bytes) else text.encode())
        if seconds == "kept":
            os.utime(place, ns=(kept.st_atime_ns, kept.st_mtime_ns))
        elif seconds is not None:
            os.utime(place, (seconds, seconds))

    return change


def aged(pattern, seconds):
    def change(folder):
        for path in folder.glob(pattern):
            os.utime(path, (seconds(path) if callable(seconds) else seconds,) * 2)

    return change


def gone(*paths):
    def change(folder):
        for path in paths:
            place = folder / path
            if place.is_dir() and not place.is_symlink():
                shutil.rmtree(place)
            else:
                place.unlink()

    return change


def swapped(one, other):
    def change(folder):
        (folder / one).rename(folder / "between")
        (folder / other).rename(folder / one)
        (folder / "between").rename(folder / other)

    return change


def linked(path, to, content=None):
    """A link in the file's place; `content` is written to what it points at."""

    def change(folder):
        target = folder / to
        if content is not None:
            target.write_text(content)
        place = folder / path
        if place.is_dir() and not place.is_symlink():
            shutil.rmtree(place)
        else:
            place.unlink(missing_ok=True)
        place.symlink_to(target if content is not None else to)

    return change


def in_place_of(path, make):
    """What is no file, in a file's place."""

    def change(folder):
        place = folder / path
        if place.is_dir() and not place.is_symlink():
            shutil.rmtree(place)
        else:
            place.unlink(missing_ok=True)
        make(place)

    return change


def moved_away(path, to):
    """A folder on another disk with a link in its place."""

    def change(folder):
        (folder / path).rename(folder / to)
        (folder / path).symlink_to(folder / to)

    return change


def both(*changes):
    def change(folder):
        for one in changes:
            one(folder)

    return change


def stated(**parts):
    """Another statement in the place of the first stage's."""

    def change(folder):
        said = json.loads((folder / STATED).read_text())
        (folder / STATED).write_text(json.dumps(said | parts))

    return change


def earlier(folder):
    """Raw, results and statements of an earlier state, as a backup brings them back."""
    kept = folder.parent / "kept"
    shutil.rmtree(kept, ignore_errors=True)
    shutil.copytree(folder, kept, symlinks=True)
    return kept


def restored(*patterns, edit=None):
    """The raw file is edited and all made again; then a backup of some files comes back."""

    def change(folder):
        import tiny_workflow

        kept = earlier(folder)
        (edit or write("one.txt", "edited\n"))(folder)
        assert tiny_workflow.run(folder)[0] == 0
        for pattern in patterns:
            for path in filter(Path.is_file, kept.glob(pattern)):
                shutil.copy2(path, folder / path.relative_to(kept))

    return change


def set_and_restored(*patterns):
    """The setting is changed and all made again; then a backup of some files comes back."""
    return restored(*patterns, edit=write("setting", "other\n"))


def named(name):
    """A file of such a name among the results, as other programs and systems leave them."""
    return lambda folder: (Path(os.fsdecode(folder / "results/one")) / os.fsdecode(name)).touch()


def signed(text):
    """Another machine's sign, and a lock as a run leaves it."""

    def change(folder):
        write(".snakemake/bladeroot_runs/running-other", text)(folder)
        write(".snakemake/locks/0.output.lock", A)(folder)
        write("one.txt", "edited\n")(folder)

    return change


def alike(folder):
    """Two campaigns of the same raw file have the same results."""
    import tiny_workflow

    write("two.txt", "raw of one\n")(folder)
    assert tiny_workflow.run(folder)[0] == 0


def relinked(folder, link):
    """As a program that frees space leaves what is alike."""
    for name in ("a.nc", "b.nc"):
        place = folder / "results" / "two" / name
        place.unlink()
        link(folder / "results" / "one" / name, place)


def copied_as(*command):
    """The folder as a command of the system copies it."""

    def change(folder):
        copy = folder.with_name("copy")
        subprocess.run([*command, folder, copy], check=True)
        shutil.rmtree(folder)
        copy.rename(folder)

    return change


def truncated(path):
    return lambda folder: os.truncate(folder / path, 3)


def zeros(path):
    """As a copy that was cut off leaves it where the length is set first."""

    def change(folder):
        size = (folder / path).stat().st_size
        (folder / path).write_bytes(bytes(size))

    return change


NOTHING, LARGE, TWICE_ONE, ALL = set(), {"large", "twice"}, {"twice"}, {"large", "twice"}
DEEP = "[" * 100_000

# change, what is done again
CASES = {
    # clocks
    "clock set back": (write("one.txt", "new\n", 1.0), LARGE),
    "before 1970": (write("one.txt", "new\n", -1e9), LARGE),
    "clock ahead": (write("one.txt", "new\n", FUTURE), LARGE),
    "results of the future, raw of now": (
        both(aged("results/**/*.nc", FUTURE), write("one.txt", "new\n")), LARGE),
    "everything of 1970, raw edited": (both(aged("**/*", 0), write("one.txt", "new\n", 0)), LARGE),
    "same length, same time": (write("one.txt", "RAW of one\n".replace("one", "eno"), "kept"), LARGE),
    "a nanosecond later, same content": (
        aged("*.txt", lambda p: p.stat().st_mtime + 1e-9), NOTHING),
    "times to the second, as tar": (aged("**/*", lambda p: int(p.stat().st_mtime)), NOTHING),
    "two seconds and a summer hour, as zip": (
        aged("**/*", lambda p: p.stat().st_mtime // 2 * 2 + 3600), NOTHING),
    "all times reversed": (
        aged("**/*", lambda p: 2e9 - p.stat().st_mtime), NOTHING),
    # copies
    "cp -r": (copied_as("cp", "-r"), NOTHING),
    "cp -rL, which follows links": (copied_as("cp", "-rL"), NOTHING),
    "cp -a": (copied_as("cp", "-a"), NOTHING),
    "half a copy: artifact cut off": (truncated(B), TWICE_ONE),
    "half a copy: zeros": (zeros(A), LARGE),
    "half a copy: no statements": (gone("results/provenance"), ALL),
    "half a copy: statement of the end alone": (gone(STATED), LARGE),
    "half a copy: no artifact of the end": (gone(B), TWICE_ONE),
    "half a copy: no artifact of the middle": (gone(A), NOTHING),
    "half a copy: nothing but statements": (gone("results/one", "results/two"), ALL),
    "half a copy: a hidden rest": (write("results/one/.a.nc.X7d9f2", "RA"), NOTHING),
    "half a copy: a part of another machine": (write("results/one/.0a1b.77.part", "RA"), NOTHING),
    # another's files
    "artifacts of two campaigns swapped": (swapped(A, "results/two/a.nc"), LARGE),
    "folders of two campaigns swapped": (swapped("results/one", "results/two"), LARGE),
    "statements of two campaigns swapped": (
        swapped(STATED, "results/provenance/large/two.json"), NOTHING),
    "raw files swapped": (swapped("one.txt", "two.txt"), LARGE),
    "artifact of an earlier state": (restored(A), LARGE),
    "results of an earlier state": (restored(A, B), LARGE),
    "statement of an earlier state": (restored(STATED), LARGE),
    "results and statements of an earlier state": (restored(A, B, STATED, TWICE), LARGE),
    "raw file of an earlier state": (restored("one.txt"), LARGE),
    "all of an earlier state": (restored("one.txt", A, B, STATED, TWICE), NOTHING),
    "raw file is emptied": (write("one.txt", ""), LARGE),
    "raw file with other line ends, time kept": (write("one.txt", b"raw of one\r\n", "kept"), LARGE),
    "raw file's other name is edited, time kept": (
        both(lambda f: os.link(f / "one.txt", f / "hard"), write("hard", "eno fo war\n", "kept")), LARGE),
    "artifact renamed in case": (lambda f: (f / B).rename(f / "results/one/B.nc"), TWICE_ONE),
    "a statement in conflict": (
        lambda f: write("results/provenance/large/one 2.json", (f / STATED).read_text())(f), NOTHING),
    "a statement in conflict, of an earlier state": (
        both(restored(), lambda f: shutil.copy(earlier(f) / STATED, f / "results/provenance/large/one 2.json")), NOTHING),
    "an artifact in conflict": (write("results/one/a (conflict).nc", "OTHER\n"), NOTHING),
    # settings
    "a setting": (write("setting", "other\n"), LARGE),
    "a setting, time kept": (write("setting", "ets\n", "kept"), LARGE),
    "a setting, .snakemake gone": (both(gone(".snakemake"), write("setting", "other\n")), LARGE),
    "a setting, records gone": (both(gone(RECORDS), write("setting", "other\n")), LARGE),
    "a setting, records empty": (
        lambda f: [p.write_text("") for p in [*(f / RECORDS).rglob("*"), f / "setting"] if p.is_file()], LARGE),
    "a setting, statements gone": (both(gone(STATED), write("setting", "other\n")), LARGE),
    "a setting, all times of 1970": (both(write("setting", "other\n"), aged("**/*", 0)), LARGE),
    "results of an earlier setting": (set_and_restored(A, B), LARGE),
    "results and statements of an earlier setting": (set_and_restored(A, B, STATED, TWICE), LARGE),
    "records of an earlier setting": (set_and_restored(RECORDS + "/*"), LARGE),
    "all but the setting of an earlier state": (set_and_restored("results/**/*"), LARGE),
    "all of an earlier setting": (set_and_restored("results/**/*", "setting"), NOTHING),
    # links and what is no file
    "raw file is a link, its target exchanged": (
        both(linked("one.txt", "t1", "raw of one\n"), linked("one.txt", "t2", "new\n"),
             aged("t2", OLD)), LARGE),
    "raw file is a link to the same": (linked("one.txt", "t1", "raw of one\n"), NOTHING),
    "artifact is a link to another file": (linked(A, "foreign", "FOREIGN\n"), LARGE),
    "artifact is another's by a hard link, and out of date": (
        both(alike, lambda f: relinked(f, os.link), write("one.txt", "new\n")), LARGE),
    "artifact is another's by a link, and out of date": (
        both(alike, lambda f: relinked(f, os.symlink), write("one.txt", "new\n")), LARGE),
    "alike artifacts are one file": (both(alike, lambda f: relinked(f, os.link)), NOTHING),
    "artifact that nothing waits for is a link to itself": (linked(A, "a.nc"), NOTHING),
    "results on another disk": (moved_away("results", "elsewhere"), NOTHING),
    "a campaign's results on another disk": (moved_away("results/one", "elsewhere"), NOTHING),
    "a loop within results": (lambda f: (f / "results/loop").symlink_to("."), NOTHING),
    "records of parameters are gone": (gone(RECORDS), ALL),
    "names of no Unicode": (named(b"\xff\xfe.nc"), NOTHING),
    "names that steer a terminal": (named(b"\x1b[2J\n.nc"), NOTHING),
    "names of 255 signs": (named(b"n" * 252 + b".nc"), NOTHING),
    "a folder with an artifact's name": (lambda f: (f / "results/one/x.nc").mkdir(), NOTHING),
    "a network disk's leftovers": (named(b".nfs0001"), NOTHING),
    "an artifact that reads a device": (linked("results/one/z.nc", "/dev/zero"), NOTHING),
    "link of Snakemake's records leads nowhere": (linked(".snakemake/metadata", "nowhere"), NOTHING),
    "Snakemake's records are a file": (in_place_of(".snakemake/metadata", Path.touch), NOTHING),
    "the contents' memory is a folder": (
        in_place_of(".snakemake/bladeroot_contents.json", Path.mkdir), NOTHING),
    "a gigabyte of nothing for a statement": (lambda f: os.truncate(f / STATED, 10**10), LARGE),
    "a gigabyte of nothing for the memory": (
        both(write(".snakemake/bladeroot_contents.json", ""), lambda f: os.truncate(f / ".snakemake/bladeroot_contents.json", 10**10)), NOTHING),
    "artifact is a folder": (in_place_of(A, Path.mkdir), LARGE),
    "artifact is a pipe": (in_place_of(A, os.mkfifo), LARGE),
    "the contents' memory is a pipe": (
        in_place_of(".snakemake/bladeroot_contents.json", os.mkfifo), NOTHING),
    "statement is a pipe": (in_place_of(STATED, os.mkfifo), LARGE),
    "statement is a link to nowhere": (linked(STATED, "nowhere"), LARGE),
    # damaged notes
    "statement nested deep": (write(STATED, DEEP), LARGE),
    "statement of another form": (stated(inputs=["one.txt"], outputs=7), LARGE),
    "statement of numbers": (stated(inputs={"one.txt": 1}, outputs={A: 2}), LARGE),
    "statement with a byte order mark": (
        lambda f: write(STATED, "\ufeff" + (f / STATED).read_text())(f), LARGE),
    "statement is not Unicode": (write(STATED, b"\xff\xfe\x00"), LARGE),
    "statement that reads a device": (stated(inputs={"/dev/zero": "0"}), LARGE),
    "a lock's file is a folder": (in_place_of(".snakemake/bladeroot_runs/starting", Path.mkdir), NOTHING),
    "contents nested deep": (write(".snakemake/bladeroot_contents.json", DEEP), NOTHING),
    "contents of another form": (
        write(".snakemake/bladeroot_contents.json", '{"one.txt": [1, {"a": 2}]}'), NOTHING),
    "records damaged": (
        lambda f: [p.write_text("{") for p in (f / RECORDS).rglob("*") if p.is_file()], ALL),
    "records empty": (
        lambda f: [p.write_text("") for p in (f / RECORDS).rglob("*") if p.is_file()], ALL),
    # locks and signs
    "a dead run's lock": (write(".snakemake/locks/0.output.lock", "x"), NOTHING),
    "sign of this machine before it was started again": (
        write(".snakemake/bladeroot_runs/running-old", os.uname().nodename), NOTHING),
}  # fmt: skip
QUICK = (
    "same length, same time", "half a copy: zeros", "artifact is a pipe", "statement nested deep",
)  # fmt: skip


def tiers(cases):
    return [pytest.param(one, marks=[pytest.mark.slow] * (one not in QUICK)) for one in cases]


def done(said):
    return set(re.findall(r"^(?:local)?rule (\w+):", said, re.MULTILINE)) - {"all"}


@pytest.fixture
def folder(finished, tmp_path):
    copy = tmp_path / "house"
    shutil.copytree(finished, copy, symlinks=True)
    return copy


@pytest.mark.parametrize("case", tiers(CASES))
def test_the_same_command_makes_it_right(case, folder, tiny):
    change, again = CASES[case]
    change(folder)
    status, said = tiny.run(folder)
    assert status == 0, said
    assert "Traceback" not in said
    assert tiny.right(folder), said
    assert done(said) == again, said
    assert "Nothing to be done" in tiny.run(folder, "--dry-run")[1]
    if (folder / "foreign").exists():
        assert (folder / "foreign").read_text() == "FOREIGN\n"
    assert not list((folder / "results").rglob(".*.part"))


# change, what is said; the results stay as they are
REFUSED = {
    "results is a file": (in_place_of("results", Path.touch), "results"),
    "results is a link to nowhere": (linked("results", "nowhere"), "results"),
    "a campaign's folder is a file": (in_place_of("results/one", Path.touch), "results/one"),
    ".snakemake is a file": (in_place_of(".snakemake", Path.touch), ".snakemake"),
    "folder of signs is a file": (
        in_place_of(".snakemake/bladeroot_runs", Path.touch), "bladeroot_runs"),
    "provenance is a file": (in_place_of("results/provenance", Path.touch), "provenance"),
    "statements of a stage are a file": (in_place_of("results/provenance/large", Path.touch), "provenance/large"),
    "logs of a stage are a file": (in_place_of("results/logs/large", Path.touch), "logs/large"),
    "records kept are a file": (in_place_of(RECORDS, Path.touch), RECORDS),
    "Snakemake's locks are a file": (in_place_of(".snakemake/locks", Path.touch), "locks"),
    "Snakemake's marks are a file": (in_place_of(".snakemake/incomplete", Path.touch), "incomplete"),
    "a campaign's results lead to another's": (linked("results/one", "two"), "results/two leads to results/one"),
    "two campaigns' results lead to one place": (
        both(moved_away("results/one", "elsewhere"), lambda f: [shutil.rmtree(f / "results/two"), (f / "results/two").symlink_to(f / "elsewhere")]), "results/two"),
    "a campaign's results lead to the statements": (linked("results/one", "provenance"), "leads to"),
    "a sign is a folder": (in_place_of(".snakemake/bladeroot_runs/running-x", Path.mkdir), "running-x"),
    "raw file is a folder": (in_place_of("one.txt", Path.mkdir), "one.txt"),
    "sign of another machine": (signed("another"), "lock"),
    "sign of another machine, empty": (signed(""), "lock"),
}  # fmt: skip


@pytest.mark.parametrize("case", tiers(REFUSED))
def test_one_line_says_what_is_wrong(case, folder, tiny):
    change, told = REFUSED[case]
    change(folder)
    two = folder / "results" / "two" / "b.nc"
    before = two.read_text() if two.exists() else None
    status, said = tiny.run(folder)
    assert status != 0, said
    assert "Traceback" not in said
    assert any(told in line for line in said.splitlines()), said
    assert before is None or two.read_text() == before


def no_locks():
    def refuse(*_):
        raise OSError(37, "No locks available")

    fcntl.flock = refuse


def no_boot_id():
    from bladeroot import runs

    runs._BOOT = Path("/nowhere")


def no_room():
    """None for Snakemake's locks: the first thing that it writes by itself once it has read all."""
    import snakemake.persistence.file as notes

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    notes.open = full


def no_temporary_folder():
    tempfile.tempdir = "/dev/null/nowhere"


def no_space(size):
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


MACHINES = {
    "a disk without locks": (no_locks, 0),
    "a system without a boot id": (no_boot_id, 0),
    "no room for Snakemake's locks": (no_room, 1),
    "no temporary folder": (no_temporary_folder, 1),
    "no space at all": (no_space(0), 1),
    "space for a byte": (no_space(1), 1),
    "space for a short artifact": (no_space(20), 1),
    "space for half a statement": (no_space(200), None),
}


@pytest.mark.parametrize("case", tiers(MACHINES))
def test_a_machine_that_lacks_something(case, folder, tiny):
    """With it the run ends well or in an answer; without it the same command continues."""
    before, expected = MACHINES[case]
    write("one.txt", "edited\n")(folder)
    status, said = tiny.run(folder, before=before)
    assert expected is None or bool(status) == bool(expected), said
    assert "Traceback" not in said
    status, said = tiny.run(folder)
    assert status == 0, said
    assert tiny.right(folder), said
    assert "Nothing to be done" in tiny.run(folder, "--dry-run")[1]


# What a profile of one's own, or a command, may ask of Snakemake.
OPTIONS = (
    "--rerun-triggers mtime", "--max-checksum-file-size 2GB", "--ignore-incomplete", "--nolock", "--quiet all",
    "--drop-metadata", "--keep-going", "--scheduler ilp", "--rerun-triggers input code", "--all-temp", "--notemp",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("options", OPTIONS)
def test_no_option_keeps_what_is_stale(options, folder, tiny):
    write("setting", "other\n")(folder)
    write("one.txt", "RAW of one\n", "kept")(folder)
    status, said = tiny.run(folder, *options.split())
    assert (status, "Traceback" in said, tiny.right(folder)) == (0, False, True), said
    assert tiny.run(folder)[0] == 0
    assert tiny.right(folder)
    assert "Nothing to be done" in tiny.run(folder, "--dry-run")[1]


def test_a_cluster_jobs_own_snakemake_counts_as_a_job_at_work(tiny, tmp_path):
    """What continues a killed run waits for it: it gives outputs their times after the stage."""
    folder = tiny.make(tmp_path / "house")
    lock = ".snakemake/bladeroot_runs/working"
    write("hook", f"flock --nonblock {lock} touch free || touch held")(folder)
    status, said = tiny.run(folder, "results/one/a.nc")
    assert status == 0, said
    assert not (folder / "held").exists()  # the rules' commands here take no lock
    status, said = tiny.run(folder, "results/one/a.nc", "--force", "--mode", "subprocess")
    assert status == 0, said
    assert (folder / "held").exists()


HOOKS = {
    "raw file changes while it is read": "[ -f once ] || { touch once; echo later >> one.txt; }",
    "raw file is replaced while it is read": (
        "[ -f once ] || { touch once; echo other > t; mv t one.txt; }"
    ),
    "statement's folder is removed meanwhile": "rm -rf results/provenance/large",
    "the records' link is removed meanwhile": "rm -f .snakemake/metadata",
}


@pytest.mark.slow
@pytest.mark.parametrize("case", HOOKS)
def test_what_changes_while_a_job_runs(case, folder, tiny):
    write("one.txt", "edited\n")(folder)
    (folder / "hook").write_text(HOOKS[case])
    tiny.run(folder)
    (folder / "hook").unlink()
    for _ in range(2):
        status, said = tiny.run(folder)
        assert status == 0, said
    assert tiny.right(folder)
    assert "Nothing to be done" in tiny.run(folder, "--dry-run")[1]


@pytest.mark.parametrize("where", ["../victim", "{root}/victim", "results/../victim"])
def test_a_foreign_statement_touches_nothing_outside(where, folder, tiny):
    victim = folder.parent / "victim"
    for place in (victim, folder / "victim"):
        place.write_text("mine")
    name = where.format(root=folder.parent)
    said = {"rule": "x", "inputs": {"one.txt": "0"}, "outputs": {name: "0"}}
    write("results/provenance/x/one.json", json.dumps(said))(folder)
    before = [place.stat().st_mtime_ns for place in (victim, folder / "victim")]
    assert tiny.run(folder)[0] == 0
    assert [place.stat().st_mtime_ns for place in (victim, folder / "victim")] == before


def test_a_backup_of_hard_links_stays_as_it_was(folder, tiny):
    backup = folder.parent / "backup"
    shutil.copytree(folder / "results", backup, copy_function=os.link, symlinks=True)
    kept = {path: path.read_bytes() for path in backup.rglob("*.nc")}
    write("one.txt", "edited\n")(folder)
    assert tiny.run(folder)[0] == 0
    assert tiny.right(folder)
    assert {path: path.read_bytes() for path in backup.rglob("*.nc")} == kept


def test_results_that_may_only_be_read_are_looked_at(folder, tiny):
    """Another user's dry run of a folder that is not to be written to."""
    for path in [folder, *folder.rglob("*")]:
        if not path.is_symlink():
            path.chmod(path.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))

    status, said = tiny.run(folder, "--dry-run")
    assert (status, "Nothing to be done" in said) == (0, True), said
    assert "Traceback" not in said


@pytest.mark.skipif(
    find_spec("snakemake_executor_plugin_slurm") is not None,
    reason="Snakemake loads all its plugins, and that for Slurm loads pandas",
)
def test_a_plan_does_not_load_the_library_of_tables(folder, tiny):
    """Which Snakemake asks of each parameter whether it is one."""
    plan = [sys.executable, "-X", "importtime", "-m", "snakemake", "-n", "--quiet", "all"]
    done = subprocess.run(plan, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert re.search(r"\| +snakemake$", done.stderr, re.MULTILINE)
    assert not re.search(r"\| +pandas$", done.stderr, re.MULTILINE)
