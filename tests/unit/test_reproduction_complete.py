"""No printed table or result figure without a row; what rests on the printed tables alone."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from bladeroot.report.ledger import ledger_section
from bladeroot.reproduction.build import ledger, missing_rows
from bladeroot.reproduction.entry import Entry, Evidence
from bladeroot.reproduction.one_dof import free_decay, slider_curves
from bladeroot.reproduction.quantities import QUANTITIES
from bladeroot.reproduction.slider import Slider

THESIS = Path(__file__).resolve().parents[2] / "resources" / "thesis"
KINDS = {"result", "input", "method", "sketch", "photo"}


def read(name):
    return yaml.safe_load((THESIS / f"{name}.yaml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def tables():
    return {
        path.stem.removeprefix("table_"): pd.read_csv(path) for path in THESIS.glob("table_*.csv")
    }


def test_every_result_has_a_row():
    assert missing_rows(read("ledger"), read("contents")) == []
    fewer = [entry for entry in read("ledger") if "Figure 5.17" not in entry.get("covers", ())]
    assert missing_rows(fewer, read("contents")) == ["Figure 5.17"]


def test_the_contents_count_through():
    """Numbers of a chapter follow each other without a gap, so none was forgotten in between."""
    contents = read("contents")
    assert {part["kind"] for group in contents.values() for part in group.values()} <= KINDS
    last = {"Table": {2: 2, 3: 2, 4: 4, 5: 2}, "Figure": {1: 7, 2: 10, 3: 20, 4: 13, 5: 18, 6: 12}}
    for group, word in (("tables", "Table"), ("figures", "Figure")):
        found = {}
        for name in contents[group]:
            number = re.fullmatch(rf"{word} (\d)\.(\d+)", name)
            if number:
                found.setdefault(int(number[1]), []).append(int(number[2]))
        assert found == {c: list(range(1, end + 1)) for c, end in last[word].items()}


def test_every_number_of_a_table_has_an_entry(tables):
    """Each table's measured or computed column is printed in full by the entries."""
    entries = [e["printed"] for e in read("ledger") if isinstance(e.get("printed"), dict)]
    for name, table in tables.items():
        covered = {}
        for printed in entries:
            if printed["table"] == name:
                rows = table.query(printed["rows"]) if "rows" in printed else table
                covered.setdefault(printed["column"], set()).update(rows.index)
        assert covered, name
        assert any(rows == set(table.index) for rows in covered.values()), name


def test_entries_name_quantities_and_have_distinct_ids():
    entries = read("ledger")
    assert len({entry["id"] for entry in entries}) == len(entries)
    used = {entry.computed for entry in (Entry(**given) for given in entries) if entry.computed}
    assert used == set(QUANTITIES)


def build(tables, ids, contents=None):
    """A ledger of the entries that need no artifact."""
    entries = [entry for entry in read("ledger") if entry["id"] in ids]
    evidence = Evidence({}, {}, {}, {}, tables, {})
    return ledger(entries, read("errata"), contents or {}, evidence)


FROM_TABLES = {
    "table-3.1-frequency-percent": ("erratum", 9),
    "table-3.1-loss-percent": ("erratum", 9),
    "table-3.2-frequency-percent": ("reproduced", 27),
    "table-5.2-kn-percent": ("erratum", 4),
    "table-5.2-kt-percent": ("erratum", 4),
    "appendix-b": ("reproduced", 22),
    "table-2.1": ("not reproducible", 0),
    "slider-frequency": ("reproduced", 1),
}


def test_verdicts_that_rest_on_the_tables_alone(tables):
    covered = {
        name for entry in read("ledger") if entry["id"] in FROM_TABLES
        for name in entry.get("covers", ())
    }  # fmt: skip
    contents = {"all": {name: {"kind": "result"} for name in covered}}
    made = build(tables, FROM_TABLES, contents)
    within = made["value_within"].groupby(made["value_row"]).sum().values
    found = {
        str(row): (str(verdict), int(count))
        for row, verdict, count in zip(
            made["row"].values, made["verdict"].values, within, strict=True
        )
    }
    assert found == FROM_TABLES
    section = ledger_section(made, read("errata"), [])
    counts = section.parts[1].rows[-1]
    assert list(counts) == ["all", "3", "0", "4", "1", "8"]


def test_a_result_without_a_row_ends_it(tables):
    contents = {"figures": {"Figure 9.9": {"kind": "result"}}}
    with pytest.raises(ValueError, match=r"no row for Figure 9\.9"):
        ledger([], [], contents, Evidence({}, {}, {}, {}, tables, {}))


def test_the_slider_keeps_its_energy_but_for_friction():
    """Undamped: below X_cr nothing is lost, above it 4 mu N0 (X - X_cr) a cycle at most."""
    model = Slider(zeta=0.0)
    rate = 2e5
    small, _ = free_decay(model, 0.9 * model.critical_amplitude, rate, 0.05)
    first, last = np.abs(small[: int(rate / 500)]).max(), np.abs(small[-int(rate / 500) :]).max()
    assert last == pytest.approx(first, rel=1e-3)
    large, _ = free_decay(model, 50 * model.critical_amplitude, rate, 0.02)
    period = int(rate / 400)
    ends = [np.abs(large[k : k + period]).max() for k in (0, large.size - period)]
    assert ends[1] < ends[0]
    assert model.stick_frequency == pytest.approx(544.73, abs=0.005)


def test_artifact_is_saved(tmp_path, tables):
    contents = {"t": {"Table of Appendix B": {"kind": "result"}, "Figure 1.1": {"kind": "photo"}}}
    made = build(tables, {"appendix-b"}, contents)
    assert (made.attrs["results"], made.attrs["no_results"]) == (1, 1)
    made.to_netcdf(tmp_path / "ledger.nc")
    xr.testing.assert_identical(xr.load_dataset(tmp_path / "ledger.nc"), made)


def test_the_slider_s_curves_meet_the_closed_form_where_a_harmonic_describes_it():
    found = slider_curves()
    assert np.abs(found["force"]).max() == pytest.approx(found.attrs["slip_force_N"])
    size, critical = found["amplitude"].values, found.attrs["critical_amplitude_m"]
    for name in ("frequency", "loss_factor"):
        closed = np.interp(size, found["balanced_amplitude"], found[f"balanced_{name}"])
        for own in (size < 0.8 * critical, size > 20.0 * critical):
            np.testing.assert_allclose(found[name].values[own], closed[own], rtol=0.02)
