"""Units of motion: spellings, sensitivities, and what is refused."""

import subprocess
import sys

import pytest
from bladeroot.io.sampling import usual_rate
from bladeroot.io.units import motion, normal_unit, quantity_of, same
from hypothesis import given, settings
from hypothesis import strategies as st


@pytest.mark.parametrize(
    ("unit", "quantity", "factor"),
    [
        ("m/s", "velocity", 1.0),
        ("µm/s", "velocity", 1e-6),
        ("MM/S", "velocity", 1e-3),
        ("Mm/s", "velocity", 1e-3),
        ("mm/sec", "velocity", 1e-3),
        ("mm s^-1", "velocity", 1e-3),
        ("in/s", "velocity", 0.0254),
        ("ips", "velocity", 0.0254),
        ("meters/second", "velocity", 1.0),
        ("[mm]", "displacement", 1e-3),
        ("nm", "displacement", 1e-9),
        ("mil", "displacement", 2.54e-5),
        ("m/s2", "acceleration", 1.0),
        ("m/s²", "acceleration", 1.0),
        ("m s⁻²", "acceleration", 1.0),
        ("ms-2", "acceleration", 1.0),
        ("m/s**2", "acceleration", 1.0),
        ("g", "acceleration", 9.80665),
        ("mg", "acceleration", 9.80665e-3),
        ("Gal", "acceleration", 0.01),
    ],
)
def test_spellings(unit, quantity, factor):
    assert motion(unit) == (quantity, pytest.approx(factor, rel=1e-12))


@pytest.mark.parametrize(
    ("unit", "sensitivity", "quantity", "factor"),
    [
        ("V", "125 mm/s/V", "velocity", 0.125),
        ("mV", "125 mm/s/V", "velocity", 1.25e-4),
        ("V", "100 mV/g", "acceleration", 98.0665),
        ("V", "10.2 mV/(m/s^2)", "acceleration", 1 / 0.0102),
        ("V", "10.2 mV/ms-2", "acceleration", 1 / 0.0102),
        ("V", "8 V/m/s", "velocity", 0.125),
        ("V", "8 mV/mm/s", "velocity", 0.125),
        ("V", "20 um/V", "displacement", 2e-5),
        ("FS", "500 mm/s/FS", "velocity", 0.5),
        ("count", "5e-3 um/s/count", "velocity", 5e-9),
        ("mm/s", "0.5", "velocity", 5e-4),
        ("V", "-125 mm/s/V", "velocity", -0.125),
    ],
)
def test_sensitivities(unit, sensitivity, quantity, factor):
    assert motion(unit, sensitivity) == (quantity, pytest.approx(factor, rel=1e-12))


@pytest.mark.parametrize(
    "unit",
    ["", "furlong", "9**9**9", "m**s", "(((", "N", "s", "m^5", "a" * 99, "s mm/s", "s   mm/s"],
)
def test_what_is_no_unit_of_motion(unit):
    with pytest.raises(ValueError, match="expected a unit"):
        motion(unit)


@pytest.mark.parametrize(
    ("unit", "sensitivity", "told"),
    [
        ("V", None, "unit V needs a sensitivity such as 125 mm/s/V"),
        ("V", "125", "unit V needs a sensitivity"),
        ("V", "0 mm/s/V", "expected a sensitivity such as"),
        ("V", "nan mm/s/V", "expected a sensitivity such as"),
        ("V", "1e999 mm/s/V", "expected a sensitivity such as"),
        ("V", "125 mm/s", "makes no motion of 'V'"),
    ],
)
def test_bad_sensitivities(unit, sensitivity, told):
    with pytest.raises(ValueError, match=told):
        motion(unit, sensitivity)


@settings(max_examples=60, deadline=None)
@given(st.text(max_size=60), st.none() | st.text(max_size=60))
def test_any_text_is_a_unit_or_one_line(unit, sensitivity):
    told = ""
    try:
        quantity, _ = motion(unit, sensitivity)
    except ValueError as error:
        quantity, told = "velocity", str(error)
    assert quantity in ("velocity", "displacement", "acceleration")
    assert "\n" not in told


@given(st.sampled_from(["", "n", "u", "m", "c", "k"]), st.sampled_from(["m/s", "m", "m/s^2"]))
def test_a_prefix_scales(prefix, unit):
    scale = {"": 1.0, "n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3}[prefix]
    assert motion(prefix + unit)[1] == pytest.approx(scale, rel=1e-12)


def test_same_and_named():
    assert same("mm/s", "mm s^-1")
    assert not same("mm/s", "m/s")
    assert not same("mm/s", "mm")
    assert normal_unit("m/s²") == "m/s^2"
    assert quantity_of("acceleration 3", None) == "acceleration"
    assert quantity_of("laser", "mm/s") == "velocity"
    assert quantity_of("laser", "V") is None


def test_usual_units_do_not_pay_for_pint():
    code = (
        "import sys; from bladeroot.io.units import motion; motion('mm/s');"
        "sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize("rate", [2048, 10240, 12800, 25600, 44100, 51200, 65536, 102400, 262144])
@pytest.mark.parametrize("digits", [4, 5, 6])
def test_a_rounded_time_step_means_the_usual_rate(rate, digits):
    mantissa, _, power = f"{1.0 / rate:.{digits - 1}e}".partition("e")
    step = float(mantissa) * 10.0 ** int(power)
    assert usual_rate(1.0 / step, 0.6 * 10.0 ** (1 - digits) / float(mantissa)) == rate


def test_where_many_rates_are_near_none_is_taken_by_chance():
    assert usual_rate(51213.4, 1e-5) is None
    assert usual_rate(51213.0) == 51213.0
    assert usual_rate(1e6 / 39 * (1 + 1e-6), 3e-6) == pytest.approx(1e6 / 39)
    assert usual_rate(51200.0 / 3 * (1 + 1e-7), 2e-7) == pytest.approx(51200 / 3)
