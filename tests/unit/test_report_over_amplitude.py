"""Tables for records without a plateau: laws whose numbers are known."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.report.over_amplitude import over_amplitude, stuck

METRES = np.geomspace(1e-6, 1e-3, 121)
DECADES = np.log10(METRES / 1e-6)


def curves(quantity):
    """One level: it falls by 1 % of 100 Hz a decade, its loss factor rises by 0.2 % a decade."""
    frequency, loss = 100.0 - DECADES, 0.01 + 0.002 * DECADES
    made = {"frequency": frequency, "loss_factor": loss}
    made |= {f"{n}_{x}": 1e-3 * v for n, v in [*made.items()] for x in ("std", "change_std")}
    made |= {f"{n}_scatter": 0.02 * made[n] for n in ("frequency", "loss_factor")}
    made["records"] = np.full(METRES.size, 3.0)
    columns = {name: (("level", "amplitude"), value[None]) for name, value in made.items()}
    slopes = {"frequency_per_decade": -1.0, "loss_factor_per_decade": 0.002}
    slopes |= {f"{name}_std": 1e-3 for name in slopes}
    level = {"mode": "m", "force": 0.0, "group": "g", "sensor": "s", "quantity": quantity}
    columns |= {name: ("level", [value]) for name, value in (level | slopes).items()}
    return xr.Dataset(columns, {"amplitude": METRES}, {"load_name": "", "load_unit": ""})


def stick(verdict="plateau not reached"):
    facts = {"record_mode": "m", "record_force": 0.0, "record_group": "g", "sensor": "s"}
    return xr.Dataset({n: ("record", [v]) for n, v in (facts | {"verdict": verdict}).items()})


def test_numbers_at_round_amplitudes_and_a_decade_later():
    values, changes = over_amplitude(curves("displacement"), stick())
    shown = {row[3]: row for row in map(tuple, values.rows)}
    assert list(shown) == ["1 µm", "3 µm", "10 µm", "30 µm", "100 µm", "300 µm", "1 mm"]
    asked = [98.0, 1.4, 0.7]  # frequency, loss factor, damping ratio
    assert [float(cell.split()[0]) for cell in shown["100 µm"][4:7]] == pytest.approx(asked, 1e-3)
    (row,) = map(tuple, changes.rows)
    assert row[3:5] == ("1 µm", "1 mm")
    # per cent of the middle frequency, and points of the loss factor
    assert float(row[5].split()[0]) == pytest.approx(-100.0 / 98.5, abs=0.01)
    assert float(row[6].split()[0]) == pytest.approx(0.2, abs=1e-3)
    assert row[7:] == ("2.0 %", "2.0 %")


@pytest.mark.parametrize(
    ("quantity", "power", "unit"), [("velocity", 1, 1e3), ("acceleration", 2, 1)]
)
def test_amplitudes_are_those_of_the_measured_quantity(quantity, power, unit):
    values, _ = over_amplitude(curves(quantity), stick())
    for row in values.rows:
        number, metres = float(row[3].split()[0].replace("\u202f", "")), row[4].split()
        metres = float(metres[0]) * {"mm": 1e-3, "µm": 1e-6}[metres[1]]
        omega = 2.0 * np.pi * float(row[5].split()[0])
        assert number == pytest.approx(unit * omega**power * metres, rel=0.02)


def test_levels_whose_records_all_have_a_plateau_are_left_to_its_table():
    assert over_amplitude(curves("velocity"), stick("plateau")) == []


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [
        (7.29, 7.34, "above 7.28; between 7.29 and 7.34 at 95 %, if the law goes on"),
        (7.27, 7.34, "near 7.28; between 7.27 and 7.34 at 95 %, if the law goes on"),
        (7.10, 7.29, "near 7.28; between 7.10 and 7.29 at 95 %, if the law goes on"),
        (7.10, 7.27, "below 7.28; between 7.10 and 7.27 at 95 %, if the law goes on"),
        (7.20, 7.36, "near 7.28; between 7.20 and 7.36 at 95 %, if the law goes on"),
        (np.nan, np.nan, "beyond 7.28"),
    ],
)
def test_the_bound_on_the_stuck_frequency_in_words(low, high, told):
    made = {"frequency_bound": 7.28, "limit_low": low, "limit_high": high}
    assert stuck(xr.Dataset(made)) == told
