"""Campaign folders whose sheet no one should write, and some that one may."""

import pytest
from answers import answer
from bladeroot.io.campaign import load_campaign
from bladeroot.io.names import LONGEST_NAME

HEAD = "record,file,mode,force_N,hold,time_s,channel,sampling_Hz,unit,sensitivity,response\n"
DESCRIPTION = """title: {title}
modes:
  1B: {{expected_Hz: {expected}, laser_x_mm: 0}}
force: {{gauge: pressure, piston_area_cm2: 17.9, full_scale_bar: 700, accuracy_percent: 1,
  accuracy_of: full-scale}}
"""
GOOD = {"record": "r1", "file": "a.csv", "mode": "1B", "force_N": "12000", "hold": "h",
        "time_s": "", "channel": "", "sampling_Hz": "", "unit": "", "sensitivity": "",
        "response": ""}  # fmt: skip
DIGITS = "9" * 400

# A cell, and what is said of it; "" where it is allowed.
CELLS = [
    ("record", "r" * (LONGEST_NAME + 1), f"{LONGEST_NAME} at most"),
    ("record", "r" * 300, "at most"),
    ("record", "r" * LONGEST_NAME, ""),
    ("record", "{record}", "letters"),
    ("record", "../r1", "letters"),
    ("record", "/etc/passwd", "letters"),
    ("record", "r1\u2028", "letters"),
    ("record", "<script>", "letters"),
    ("record", "$(touch x)", "letters"),
    ("record", "-r", "letters"),
    ("record", "", "letters"),
    ("record", "r\u00fc", "letters"),
    ("file", "{record}.nc", "none of { }"),
    ("file", "run{1}.csv", "none of { }"),
    ("file", "<b>.csv", "none of { }"),
    ("file", "f" * 300 + ".csv", "not found"),
    ("file", "d/" * 3000 + "a.csv", "not found"),
    ("file", "a" * 5000, "must end in"),
    ("file", ".csv", "must end in"),
    ("file", "/dev/zero", "must end in"),
    ("file", "folder.csv", "not found"),
    ("file", "loop.csv", "not found"),
    ("file", "~/a.csv", "not found"),
    ("mode", "{mode}", "must be one of"),
    ("mode", "1B;2B", "must be one of"),
    ("force_N", DIGITS, "finite"),
    ("force_N", "1" + "0" * 5000, "finite"),
    ("force_N", "1e999", "finite"),
    ("force_N", "-0", "positive"),
    ("force_N", "1_2", "finite"),
    ("force_N", "0x10", "finite"),
    ("force_N", "１２０００", ""),
    ("force_N", "=1+1", "finite"),
    ("force_N", "5e-324", "positive"),
    ("time_s", DIGITS, "finite"),
    ("time_s", "1e308", ""),
    ("sampling_Hz", DIGITS, "finite"),
    ("hold", "$\\frac{$", ""),
    ("hold", "<script>alert(1)</script>", ""),
    ("hold", "h" * 5000, ""),
    ("hold", "{hold}", ""),
    ("channel", "9" * 5000, ""),
    ("channel", "../x", ""),
    ("unit", "m/s" * 2000, "unit"),
    ("unit", "m**" + DIGITS, "unit"),
    ("unit", "__import__('os').system('touch executed')", "unit"),
    ("unit", "(" * 1000, "unit"),
    ("unit", "m/s/0", "unit"),
    ("unit", "9" * 5000 + " m/s", "unit"),
    ("sensitivity", DIGITS, ""),
    ("sensitivity", "0", ""),
    ("sensitivity", "10**10**10 m/s/V", ""),
    ("sensitivity", "__import__('os').abort()", ""),
    ("response", "high-pass " + DIGITS + " Hz", "response"),
    ("response", "high-pass 1e999 Hz", "response"),
    ("response", "../high_pass 1 Hz", "response"),
]


def campaign(folder, sheet, title="a", expected="540", name="campaign"):
    place = folder / name
    place.mkdir()
    text = DESCRIPTION.format(title=title, expected=expected)
    (place / "campaign.yaml").write_text(text, encoding="utf-8")
    content = sheet if isinstance(sheet, bytes) else sheet.encode()
    (place / "records.csv").write_bytes(content)
    (place / "a.csv").touch()
    (place / "folder.csv").mkdir()
    (place / "loop.csv").symlink_to("loop.csv")
    return place


def row(**changes):
    return ",".join((GOOD | changes).values()) + "\n"


@pytest.mark.parametrize(("column", "cell", "told"), CELLS, ids=range(len(CELLS)))
def test_cell(column, cell, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = campaign(tmp_path, HEAD + row(**{column: cell}))
    before = sorted(tmp_path.rglob("*"))
    lines = answer(lambda: load_campaign(place), "records.csv", told)
    assert bool(lines) or not told
    assert sorted(tmp_path.rglob("*")) == before  # nothing was executed


SHEETS = {
    "ids that differ by case": ((HEAD + row() + row(record="R1")).encode(), "stands in row 2"),
    "ids of two normal forms": ((HEAD + row(record="re\u0301")).encode(), "letters"),
    "file in another normal form": ((HEAD + row(file="\u00e9.csv")).encode(), "not found"),
    "binary": (b"\x00\x01\x02" * 99, "text"),
    "control": (HEAD.encode() + row(hold="\x07").encode(), "control"),
    "utf-16": ((HEAD + row()).encode("utf-16"), ""),
    "mark": ((HEAD + row()).encode("utf-8-sig"), ""),
    "cp1252": ((HEAD + row(hold="\u00fc")).encode("cp1252"), ""),
    "one quote": ((HEAD + '"' + row()).encode(), ""),
    "huge field": ((HEAD + row(hold="h" * 200_000)).encode(), "field larger"),
    "many columns": (("a" + ",a" * 50_000 + "\n").encode(), "unknown column"),
    "blank lines": (HEAD.encode() + b"\n" * 9999, "no usable row"),
    "short row": ((HEAD + "r1,a.csv\n").encode(), "cells"),
    "macintosh ends": ((HEAD + row()).replace("\n", "\r").encode(), ""),
}


@pytest.mark.parametrize("case", SHEETS)
def test_sheet(case, tmp_path):
    content, told = SHEETS[case]
    lines = answer(lambda: load_campaign(campaign(tmp_path, content)), "records.csv", "")
    assert any(told in line for line in lines) if told else True


@pytest.mark.parametrize(
    "name",
    ["c" * (LONGEST_NAME + 1), "{c}", "<c>", "a b", "\u00fc", "-c", "bench", "Bench", "provenance"],
)
def test_folder(name, tmp_path):
    place = campaign(tmp_path, HEAD + row(), name=name)
    assert answer(lambda: load_campaign(place), "campaign")


@pytest.mark.parametrize("path", ["/" + "x" * 400, "none", "a\0b", "x/" * 3000])
def test_no_folder(path):
    assert answer(lambda: load_campaign(path), "campaign folder")


@pytest.mark.parametrize("expected", [DIGITS, "1.0e+400", ".nan", "-1", "0", "true", "'540'"])
def test_number_of_a_description(expected, tmp_path):
    place = campaign(tmp_path, HEAD + row(), expected=expected)
    assert answer(lambda: load_campaign(place), "campaign.yaml")
