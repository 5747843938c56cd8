"""What a job states of the files that it read and made: the hash of their content, a file a job.

By it the next run knows what is current, whatever the files' times say, and so does
`bladeroot check`. Statements lie with the results and travel with them. Settings, code and the set
of inputs are Snakemake's to compare; its records lie beside the statements.
"""

import hashlib
import json
import os
import time
from base64 import urlsafe_b64encode
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from bladeroot.files import save_text
from bladeroot.provenance import canonical_json, environment
from bladeroot.schema import parse_yaml

FOLDER = "provenance"
# Folders of results/ whose files no job takes as an input.
_FOLDERS_BESIDE = (FOLDER, "logs", "benchmarks")
# Endings of what jobs make.
_MADE_SUFFIXES = {".nc", ".svg", ".html", ".json", ".vtu"}
# The time (s) that an outdated file is given; 0 is none at all to Snakemake.
_LONG_AGO_S = 1.0
# Stands for the content of a file that changed while a job read it.
UNSURE = "changed while it was read"
# Seconds within which some disks give two changes of a file the same time.
_DISK_TICK_S = 2.0
# The longest note that is read: what 100,000 records need.
_LONGEST_NOTE_BYTES = 1 << 28


class Contents:
    """Hashes of files' contents, remembered as long as a file is the same one to the system.

    place: a file that keeps them from run to run; without it, or where it is damaged, files are
    read again.
    """

    def __init__(self, place: str | Path | None = None) -> None:
        """Of what `place` knows, and nothing where it is damaged."""
        self._place = Path(place) if place else None
        self._known, self._read = {}, 0
        with suppress(OSError, ValueError, AttributeError, TypeError, RecursionError):
            known = _read_json(self._place)
            self._known = {str(path): (list(who), str(what)) for path, (who, what) in known.items()}

    def of(self, path: str | Path) -> str:
        """Hash of a file, or of all files of a folder with their names; "" where there is none.

        What is neither (a pipe, a device) has no content, or no end.
        """
        if os.path.isdir(path):
            inside = sorted(one for one in Path(path).rglob("[!.]*") if one.is_file())
            said = [f"{one.relative_to(path)} {self.of(one)}" for one in inside]
            return hashlib.sha256("\n".join(said).encode()).hexdigest()
        who = identity(path) if os.path.isfile(path) else None
        if who is None:
            return ""
        known = self._known.get(str(path))
        if known is not None and known[0] == who:
            return known[1]
        begun, what = time.time(), _hash(path)
        # one that has just been written may be changed again without another time
        if max(who[2:]) / 1e9 < begun - _DISK_TICK_S:
            self._known[str(path)] = who, what
            self._read += 1
        return what

    def set_time(self, path: str | Path, seconds: float) -> None:
        """Give a file, or a folder and Snakemake's mark in it, a time of change."""
        if _time(path) == seconds:
            return
        known = self._known.get(str(path))
        same = known is not None and known[0] == identity(path)
        for one in (path, os.path.join(path, ".snakemake_timestamp")):
            with suppress(OSError):
                os.utime(one, (seconds, seconds))
                os.utime(one, (seconds, seconds), follow_symlinks=False)
        if same and identity(path):
            self._known[str(path)] = identity(path), known[1]
            self._read += 1

    def keep(self) -> None:
        """Write down what is known for the next run, if it is more than before."""
        if self._place and self._read:
            # they only save time
            with suppress(ValueError):
                save_text(json.dumps(self._known), self._place)


def _read_json(path: Path) -> object:
    # a pipe has no end
    if not (path.is_file() and path.stat().st_size < _LONGEST_NOTE_BYTES):
        raise ValueError(f"{path} is not a note")
    return json.loads(path.read_text(encoding="utf-8"))


def _hash(path: str | Path) -> str:
    """Of a file's bytes; of YAML, whose comments and layout nobody reads, of what it says."""
    if Path(path).suffix == ".yaml":
        with suppress(ValueError, TypeError):
            return hashlib.sha256(canonical_json(parse_yaml(path)).encode()).hexdigest()
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def identity(path: str | Path) -> list[int] | None:
    """What changes when a file is written, replaced or moved; None where it is not there.

    The time of change alone can be set back (mv, cp -p, unzip), and a file that is moved with its
    folder keeps all its times.
    """
    try:
        found = os.stat(path)
    except OSError:
        return None
    return [found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns]


def state(
    place: Path,
    rule: str,
    inputs: dict[str, str],
    outputs: dict[str, str],
    settings: list[str],
    config: dict,
) -> None:
    """Write a job's statement.

    inputs, outputs: content hashes by path. settings: its parameters, the hash of its code among
    them. config: what the run was given by `--config`.
    """
    stated = {
        "rule": rule,
        "inputs": inputs,
        "outputs": outputs,
        "settings": settings,
        "config": config,
        "environment": environment(),
    }
    save_text(json.dumps(stated, indent=1), place)


def statements(results: Path, stage: str = "") -> list[dict]:
    """All statements, or a stage's; one that is damaged says nothing, and its job is done again."""
    found = []
    for place in sorted((results / FOLDER / stage).rglob("*.json")):
        with suppress(OSError, ValueError, RecursionError):
            stated = _read_json(place)
            if _is_statement(stated, results):
                found.append(stated)
    return found


def _is_statement(stated: object, results: Path) -> bool:
    """Whether it has the form of one, of files in `results` alone: their times are set."""
    if not isinstance(stated, dict) or "rule" not in stated:
        return False
    parts = [stated.get("inputs"), stated.get("outputs")]
    if not all(isinstance(part, dict) and all(map(_is_text, part.values())) for part in parts):
        return False
    made = map(os.path.normpath, parts[1])
    return all(Path(path).is_relative_to(results) for path in made)


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def outdated(stated: Iterable[dict], contents: Contents, results: Path) -> dict[str, str]:
    """Of each output that is there: "" if a statement holds, else why none does.

    A file whose batch has another name now has two statements; one that holds is enough. An input
    that is not there is made again or asked for by name, which is not for a statement to say.
    Snakemake compares settings by its own records; where one is lost, or is not of the state that
    a statement tells, nobody knows them.
    """
    why = {}
    for one in stated:
        changed = [
            path for path, said in one["inputs"].items() if contents.of(path) not in ("", said)
        ]
        for output, said in one["outputs"].items():
            if why.get(output) == "" or not os.path.exists(output):
                continue
            if contents.of(output) != said:
                why[output] = "it was altered or replaced after it was made"
            elif not _recorded(one, output, results / FOLDER / "snakemake"):
                why[output] = "no record, or another state's, has its settings"
            else:
                why[output] = f"{changed[0]} has changed since" if changed else ""
    return why


def _recorded(one: dict, output: str, records: Path) -> bool:
    """Whether Snakemake's record of an output has the inputs and the settings that are stated."""
    name = urlsafe_b64encode(output.encode()).decode()
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        # it spreads what is too long for a name over folders
        most = os.pathconf(records, "PC_NAME_MAX") - 1
        *before, last = (name[k : k + most] for k in range(0, len(name), most))
        record = _read_json(records.joinpath(*(f"@{part}" for part in before), last))
        said = {*one.get("settings", ()), *map(repr, one.get("settings", ()))}
        return said.issuperset(record["params"]) and set(record["input"]) == set(one["inputs"])
    return False


@dataclass(frozen=True)
class Part:
    """A part of a batch that one job works through: what it is made of, and where it goes.

    facts: what is asked of it alone, its name under `record`; inputs and outputs: its own files.
    """

    facts: Mapping
    inputs: Sequence[str]
    outputs: Sequence[str]


def still_current(
    stated: Iterable[dict], shared: Sequence[str], inputs: Sequence[str], parts: Iterable[Part]
) -> set[str]:
    """Names of the parts that need not be made again: an earlier batch's statement holds for them.

    shared, inputs: settings and input files of all parts. A job's first setting is the list of its
    parts' facts, and its others are the shared ones; a part is current if a statement has the same
    of both, and the content that its inputs and outputs have now.
    """
    contents, wanted, found = Contents(), {one.facts["record"]: one for one in parts}, set()
    for one in stated:
        first, *others = one.get("settings") or [""]
        if others != list(shared):
            continue
        files = one["inputs"] | one["outputs"]
        with suppress(ValueError, TypeError, KeyError):
            for facts in json.loads(first):
                part = wanted.get(facts["record"])
                if part is None or part.facts != facts:
                    continue
                paths = (*inputs, *part.inputs, *part.outputs)
                same = all(contents.of(path) == files.get(path, UNSURE) for path in paths)
                if same and not any(map(os.path.islink, part.outputs)):
                    found.add(facts["record"])
    return found


def renew(part: Part) -> None:
    """Give a part's files the present time, as if its job had made them again."""
    for path in part.outputs:
        os.utime(path)


def other_environment(stated: dict) -> str:
    """What a job was done with, if it is not what is here: versions of Python and libraries."""
    was = stated.get("environment", environment())
    return "" if was == environment() else f"made with {was}, and here is {environment()}"


def unstated(results: Path, known: Iterable[str]) -> list[str]:
    """What looks like an output and no statement names: of another version, or of a cut-off job."""
    named, found = set(known), []
    for folder, inside, files in os.walk(results):
        if Path(folder) == results:
            inside[:] = [name for name in inside if name not in _FOLDERS_BESIDE]
        if folder in named:  # an output that is a folder
            inside.clear()
            continue
        paths = (
            os.path.join(folder, name) for name in files if Path(name).suffix in _MADE_SUFFIXES
        )
        found += [path for path in paths if path not in named and not _hidden(path)]
    return found


def _hidden(path: str) -> bool:
    return os.path.basename(path).startswith(".")


def settle(results: Path, contents: Contents) -> dict[str, str]:
    """Give outputs the times by which Snakemake then decides as the statements say.

    What is outdated becomes older than its inputs; what is current, no older than them. Returns why
    each outdated output is so.
    """
    stated = statements(results)
    why = outdated(stated, contents, results)
    late = {path: reason for path, reason in why.items() if reason}
    late |= dict.fromkeys(unstated(results, why), "nothing says what it was made of")
    for path in filter(os.path.islink, {path for one in stated for path in one["outputs"]}):
        within = os.path.realpath(path).startswith(os.path.join(os.path.realpath(results), ""))
        if within or why.get(path) != "":
            os.unlink(path)  # jobs make no links; what it leads to is another's
            late[path] = "it is a link to another file"
    newest = max((_time(path) for one in stated for path in one["inputs"]), default=0.0)
    newest, now = max(newest, 2 * _LONG_AGO_S), time.time()
    for path in _inputs_of(late, stated) - late.keys():
        # as some archives leave it, or of a clock that is ahead, which Snakemake refuses
        if not _LONG_AGO_S < _time(path) <= now:
            contents.set_time(path, min(newest, now))
    if any(_older_than_inputs(one, why) for one in stated):
        newest = max(now, newest)
        for path, reason in why.items():
            if not reason:
                contents.set_time(path, newest)
    # to Snakemake a job's benchmark is an output, too
    for path in (results / "benchmarks").rglob("*.tsv"):
        if _time(path) < newest:
            contents.set_time(path, newest)
    for path in late:  # last: a current output may be another name of the same file
        contents.set_time(path, _LONG_AGO_S)
    contents.keep()
    return late


def _inputs_of(outputs: dict[str, str], stated: list[dict]) -> set[str]:
    of_them = (one for one in stated if outputs.keys() & one["outputs"].keys())
    return {path for one in of_them for path in one["inputs"]}


def _older_than_inputs(one: dict, why: dict[str, str]) -> bool:
    """Whether a current output of a job is older than one of its inputs."""
    oldest = min((_time(path) for path in one["outputs"] if why.get(path) == ""), default=None)
    return oldest is not None and oldest < max(map(_time, one["inputs"]), default=0)


def _time(path: str) -> float:
    """Time of change; Snakemake takes that of the mark in a folder, and the later one of a link."""
    mark = os.path.join(path, ".snakemake_timestamp")
    with suppress(OSError):
        place = mark if os.path.isdir(path) else path
        return max(os.stat(place).st_mtime, os.lstat(place).st_mtime)
    return 0.0
