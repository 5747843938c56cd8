"""YAML that is a bomb, a hole, no YAML, or a document of another kind."""

import re
from pathlib import Path

import pytest
from answers import answer
from bladeroot.rom.file import load_structure
from bladeroot.schema import DEEPEST_NESTING, read_yaml

NINE = ",".join(["*a{0}"] * 9)
TEXTS = {
    "alias bomb": (
        "a0: &a0 [x,x,x,x,x,x,x,x,x]\n"
        + "".join(f"a{k}: &a{k} [{NINE.format(k - 1)}]\n" for k in range(1, 12)),
        "values at most",
    ),
    "merge bomb": (
        "a0: &a0 {x: 1}\n"
        + "".join(f"a{k}: &a{k} {{<<: [{NINE.format(k - 1)}]}}\n" for k in range(1, 12)),
        "values at most",
    ),
    "flow nested": ("a: " + "[" * 100_000, "nested"),
    "keys nested": ("{a: " * 5000 + "}" * 5000, "nested"),
    "block nested": ("".join(" " * k + "- \n" for k in range(500)), "nested"),
    "just too deep": ("a: " + "[" * (DEEPEST_NESTING + 1) + "]" * (DEEPEST_NESTING + 1), "nested"),
    "holds itself": ("a: &a [*a]", "stands within"),
    "key holds itself": ("&a {? *a : 1}", "stands within"),
    "deep loop": ("a: &a {b: {c: [1, *a]}}", "stands within"),
    "many values": ("a: [" + "1," * 250_000 + "1]", "values at most"),
    "large": ("a: '" + "x" * 3_000_000 + "'", "bytes at most"),
    "digits of a bomb": ("title: " + "9" * 5000, "digits"),
    "digits beyond a float": ("title: " + "9" * 400, "digits"),
    "float beyond a float": ("title: 1.0e+999", "finite"),
    "nan": ("title: .nan", "finite"),
    "no float": ("a: !!float x", "float"),
    "no number": ("a: !!int x", "int"),
    "no date": ("a: 2024-99-99", "month"),
    "no zone": ("a: 2001-12-14t21:59:43.10-99:99", "offset"),
    "no base64": ("a: !!binary '%%%'", ""),
    "python object": ("!!python/object/apply:os.system [touch executed]", "constructor"),
    "python name": ("a: !!python/name:os.system", "constructor"),
    "key is a list": ("? [a]\n: 1", "unhashable"),
    "key is a mapping": ("? {a: 1}\n: 1", "unhashable"),
    "unknown reference": ("a: *b", "undefined alias"),
    "two documents": ("a: 1\n---\nb: 2", "single document"),
    "zero byte": ("a: \0", "not a YAML text"),
    "tab": ("\t- a", "not a YAML text"),
    "unclosed": ("a: [1, 2", "not a YAML text"),
    "surrogate": ('a: "\\ud800"', "not a YAML text"),
    "set": ("!!set {a, b}", "object"),
    "pairs": ("!!omap [a: 1]", "object"),
    "list": ("[1, 2]", "object"),
    "text": ("no mapping", "object"),
    "number": ("7", "object"),
    "empty": ("", "empty"),
    "comment": ("# nothing\n", "empty"),
    "long key": ("k" * 900 + ": 1", "Additional"),
    "script as key": ("<script>alert(1)</script>: 1", "Additional"),
    "latin-1": ("title: \udcfc", "not a YAML text"),
}


@pytest.mark.parametrize("schema", ["campaign", "structure"])
@pytest.mark.parametrize("case", TEXTS)
def test_yaml(case, schema, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, told = TEXTS[case]
    path = tmp_path / "document.yaml"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    assert answer(lambda: read_yaml(path, schema), "document.yaml", told)
    assert sorted(tmp_path.iterdir()) == [path]  # nothing was executed


# A key of a shipped structure's file, and a number that would fill the memory or never end.
NUMBERS = [
    ("width_elements", "1000000000"),
    ("jaw_elements", "9" * 400),
    ("span_element_mm", "1.0e-9"),
    ("root_element_mm", "5.0e-324"),
    ("root_element_mm", "0"),
    ("beam_modes", "1000000000"),
    ("slot_modes", "-1"),
    ("slot_modes", "2.5"),
    ("width_mm", "1.0e+400"),
    ("lip_mm", ".nan"),
    ("density_kg_m3", "'7800'"),
    ("poisson_ratio", "0.5"),
    ("young_modulus_GPa", "9" * 5000),
    ("name", "n" * 101),
]
SHIPPED = Path(__file__).resolve().parents[2] / "resources" / "structures" / "dovetail-H.yaml"


@pytest.mark.parametrize(("key", "number"), NUMBERS, ids=range(len(NUMBERS)))
def test_number_of_a_structure(key, number, tmp_path):
    path = tmp_path / "structure.yaml"
    text, count = re.subn(rf"\b{key}: [^,}}\n]+", f"{key}: {number}", SHIPPED.read_text(), count=1)
    assert count == 1
    path.write_text(text)
    assert answer(lambda: load_structure(path), "structure.yaml")
