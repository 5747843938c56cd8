"""What is current is decided by content: old times hide nothing, and new ones redo nothing."""

import json
import os
from base64 import urlsafe_b64encode
from pathlib import Path

import pytest
from bladeroot import statement

OLD = 1e9


@pytest.fixture
def results(tmp_path, monkeypatch):
    """raw -> results/a.nc -> results/b.nc, each stated."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("raw", "1"), ("results/a.nc", "2"), ("results/b.nc", "3")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    contents = statement.Contents()
    for source, made in (("raw", "results/a.nc"), ("results/a.nc", "results/b.nc")):
        place = tmp_path / "results" / "provenance" / f"{made[-4]}.json"
        said = [{path: contents.of(path)} for path in (source, made)]
        statement.state(place, "rule", *said, ["a setting"], {})
        record(tmp_path, made, {"params": ["'a setting'"], "input": [source]})
    return tmp_path / "results"


def record(folder, made, said):
    """As Snakemake keeps what it knows of an output."""
    place = folder / "results" / "provenance" / "snakemake"
    place.mkdir(parents=True, exist_ok=True)
    (place / urlsafe_b64encode(made.encode()).decode()).write_text(json.dumps(said))


def late(contents=None):
    return statement.settle(statement.Path("results"), contents or statement.Contents())


def replace(path, text, seconds=OLD):
    with open(path, "w") as file:
        file.write(text)
    os.utime(path, (seconds, seconds))


def test_nothing_is_late_whatever_the_times_say(results):
    for times in ((3e9, OLD, OLD), (OLD, 2 * OLD, OLD), (0.0, 0.0, 0.0)):
        for path, seconds in zip(("raw", "results/a.nc", "results/b.nc"), times, strict=True):
            os.utime(path, (seconds, seconds))
        assert late() == {}
        assert os.path.getmtime("raw") <= os.path.getmtime("results/a.nc")
        assert os.path.getmtime("results/a.nc") <= os.path.getmtime("results/b.nc")


@pytest.mark.parametrize("seconds", [OLD, 1.0, 0.0])
def test_an_older_file_of_other_content_makes_its_output_older(results, seconds):
    replace("raw", "other", seconds)
    assert late() == {"results/a.nc": "raw has changed since"}
    assert 0 < os.path.getmtime("results/a.nc") < os.path.getmtime("raw")
    replace("raw", "1", seconds)
    assert late() == {}


@pytest.mark.parametrize("text", ["", "other"])
def test_an_altered_output_is_late_and_what_read_it(results, text):
    replace("results/a.nc", text)
    assert set(late()) == {"results/a.nc", "results/b.nc"}
    assert os.path.getmtime("results/a.nc") < os.path.getmtime("raw")


@pytest.mark.parametrize(
    "said", [{}, [], {"params": ["'another'"], "input": ["raw"]}, {"params": [], "input": ["more"]}]
)
def test_what_no_record_has_the_settings_of_is_late(said, results):
    """Snakemake finds no setting changed where its record is gone, or of another state."""
    record(results.parent, "results/a.nc", said)
    assert set(late()) == {"results/a.nc"}


def test_a_file_is_read_again_as_long_as_a_change_could_have_the_same_time(tmp_path, monkeypatch):
    """Some disks have times of whole seconds."""
    whole = statement.identity
    monkeypatch.setattr(
        statement,
        "identity",
        lambda path: [n if k < 2 else n // 10**9 * 10**9 for k, n in enumerate(whole(path))],
    )
    contents, place = statement.Contents(), tmp_path / "raw"
    found = set()
    for text in "123456":
        place.write_text(text)
        found.add(contents.of(place))
    assert len(found) == 6


@pytest.mark.parametrize("text", ["", "{", "[]", '{"rule": 1}'])
def test_a_damaged_statement_states_nothing(results, text):
    (results / "provenance" / "b.json").write_text(text)
    assert set(late()) == {"results/b.nc"}


def test_one_statement_that_holds_is_enough(results):
    """A batch that is split leaves the statement of the whole one."""
    said = {"raw": "another content"}, {"results/a.nc": "another content"}
    statement.state(results / "provenance" / "0.json", "rule", *said, [], {})
    assert late() == {}


def test_a_file_that_changed_while_it_was_read_is_not_trusted(results):
    made = {"results/a.nc": statement.Contents().of("results/a.nc")}
    place = results / "provenance" / "a.json"
    statement.state(place, "rule", {"raw": statement.UNSURE}, made, [], {})
    assert set(late()) == {"results/a.nc"}


def test_an_input_that_is_gone_says_nothing(results):
    os.unlink("raw")
    assert late() == {}


def test_contents_are_remembered_until_the_file_is_another(results, tmp_path):
    kept = tmp_path / "kept.json"
    contents = statement.Contents(kept)
    first = contents.of("raw")
    contents.keep()
    replace("raw", "2", os.path.getmtime("raw"))  # as long, and of the same time
    assert statement.Contents(kept).of("raw") != first
    for text in ("", "{", "[1]", '{"raw": 1}', '{"raw": [1, 2]}'):
        kept.write_text(text)
        replace("raw", "1")
        assert statement.Contents(kept).of("raw") == first


def test_a_folder_is_its_files_and_their_names(tmp_path):
    folder = tmp_path / "folder"
    (folder / "in").mkdir(parents=True)
    (folder / "in" / "a").write_text("1")
    (folder / ".snakemake_timestamp").touch()
    seen = {statement.Contents().of(folder)}
    (folder / "in" / "a").write_text("2")
    seen.add(statement.Contents().of(folder))
    (folder / "in" / "a").rename(folder / "in" / "b")
    seen.add(statement.Contents().of(folder))
    assert len(seen) == 3
    (folder / ".snakemake_timestamp").write_text("x")
    assert statement.Contents().of(folder) in seen


def test_yaml_is_what_it_says(tmp_path):
    place = tmp_path / "a.yaml"
    seen = set()
    for text in ("a: 1\nb: 2\n", "b:  2  # two\na: 1\n", "a: 1\nb: 3\n", "a: [", "a: ["):
        place.write_text(text)
        seen.add(statement.Contents().of(place))
    assert len(seen) == 3


@pytest.fixture
def batch(tmp_path, monkeypatch):
    """Two parts of a batch, stated, with an input of both."""
    monkeypatch.chdir(tmp_path)
    parts = [
        statement.Part({"record": name, "end_s": 1}, [f"{name}.wav"], [f"results/{name}.nc"])
        for name in "ab"
    ]
    (tmp_path / "results").mkdir()
    files = ["both", *(path for part in parts for path in (*part.inputs, *part.outputs))]
    for path in files:
        (tmp_path / path).write_text(path)
    contents = statement.Contents()
    made = {path: contents.of(path) for path in files}
    outputs = {path: made.pop(path) for path in files if path.startswith("results")}
    settings = [statement.canonical_json([part.facts for part in parts]), "set", "code"]
    statement.state(Path("results/provenance/b.json"), "rule", made, outputs, settings, {})
    return parts


def kept(parts, shared=("set", "code"), inputs=("both",)):
    return statement.still_current(statement.statements(Path("results")), shared, inputs, parts)


def altered(path):
    return lambda: replace(path, "other", os.path.getmtime(path))


def as_link(path):
    os.rename(path, "elsewhere")
    os.symlink("elsewhere", path)


@pytest.mark.parametrize(
    ("change", "left"),
    [
        (lambda: None, "ab"),
        (altered("a.wav"), "b"),
        (altered("results/b.nc"), "a"),
        (altered("both"), ""),
        (lambda: os.remove("results/a.nc"), "b"),
        (lambda: os.remove("b.wav"), "a"),
        (lambda: as_link("results/a.nc"), "b"),
        (altered("results/provenance/b.json"), ""),
    ],
)
def test_parts_of_a_batch_are_kept_by_content(batch, change, left):
    change()
    assert kept(batch) == set(left)


def test_parts_of_a_batch_are_made_again_for_other_settings(batch):
    assert kept(batch, ("set", "other code")) == kept(batch, ("code", "set")) == set()
    other = replace_facts(batch[0], {"record": "a", "end_s": 2})
    new = replace_facts(batch[0], {"record": "c", "end_s": 1})
    assert kept([other, new, batch[1]]) == {"b"}


def replace_facts(part, facts):
    return statement.Part(facts, part.inputs, part.outputs)
