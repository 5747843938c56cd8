"""Numbers as text, tables without empty columns, pages that escape what they are given."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.report.numbers import NONE, fixed, listed, percent, significant, span, with_std
from bladeroot.report.page import Picture, Section, Table, render
from bladeroot.report.score import score


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (fixed(1445.574, 2), "1\u202f445.57"),
        (fixed(-0.004, 2), "0.00"),
        (percent(-1e-9), "0.0 %"),
        (fixed(np.nan, 2), NONE),
        (significant(0.0012345, 2), "0.0012"),
        (significant(0.9962, 2), "1.0"),
        (significant(1234567.0, 3), "1\u202f234\u202f567"),
        (significant(0.0), "0"),
        (significant(3.2e-9, 2), "3.2·10⁻⁹"),
        (significant(-3.2e-9, 2, "N"), "-3.2·10⁻⁹ N"),
        (significant(np.inf), NONE),
        (span(8.0e-6, 1.8e-5, 2), "(8.0 to 18)·10⁻⁶"),
        (span(0.25, 12.0, 2), "0.25 to 12"),
        (span(3.0e-8, 12.0, 2), "3.0·10⁻⁸ to 12"),
        (span(0.3501, 0.3502, 2), "0.35"),
        (span(1.04e-7, 1.01e-7, 2), "1.0·10⁻⁷"),
        (span(0.0, 1.0e-7, 2), "0 to 1.0·10⁻⁷"),
        (with_std(539.051, 2.349, 2, "Hz"), "539.1 ± 2.3 Hz"),
        (with_std(0.77, 13.3, 2, "µm"), "1 ± 13 µm"),
        (with_std(-1523.4, 253.7, 2), "-1\u202f520 ± 250"),
        (with_std(0.14, 0.0997, 3), "0.14 ± 0.10"),
        (with_std(0.22000073, 9.4e-7, 3, "%"), "0.220001 ± 0.000001 %"),
        (with_std(-1.523e-4, 6.7e-6, 2, "1/K"), "(-1.523 ± 0.067)·10⁻⁴ 1/K"),
        (with_std(-1.4e-4, 7.8e-7, 2, "1/K"), "(-1.4000 ± 0.0078)·10⁻⁴ 1/K"),
        (with_std(539.051, np.nan, 2), "539.05"),
        (with_std(np.nan, 1.0, 2), NONE),
        (with_std(242.91234, 0.0012, 2), "242.9123 ± 0.0012"),
        (with_std(0.4, 0.0, 3), "0.400 ± 0.000"),
        (percent(0.0235), "2.4 %"),
        (listed([]), ""),
        (listed(["a"]), "a"),
        (listed(["a", "b", "c"]), "a, b and c"),
    ],
)
def test_numbers_as_text(text, expected):
    assert text == expected


def test_columns_of_dashes_are_dropped():
    table = Table("t", ["a", "b", "c"], [["1", NONE, "x"], ["2", NONE, NONE]])
    assert table.header == ["a", "c"]
    assert table.rows == [["1", "x"], ["2", NONE]]


def page(**changes):
    options = {
        "title": "A <joint>",
        "subtitle": "s",
        "simulated": False,
        "sections": [Section("One", ["a < b", Picture("<svg id='x'/>", "c & d")])],
        "footer": "f",
    }
    return render(**{**options, **changes})


def test_text_is_escaped_and_drawings_are_not():
    text = page()
    assert "A &lt;joint&gt;" in text
    assert "a &lt; b" in text
    assert "<svg id='x'/>" in text
    assert "c &amp; d" in text


def test_simulated_is_said_at_the_top_and_only_when_it_is():
    assert "Simulated records" in page(simulated=True)
    assert "Simulated records" not in page()


def stick(frequency, std, reached):
    return xr.Dataset(
        {
            "stick_frequency": ("record", frequency),
            "stick_frequency_std": ("record", std),
            "plateau_reached": ("record", reached),
            "record_force": ("record", [1e3] * len(frequency)),
        },
        {"record": [f"r{i}" for i in range(len(frequency))]},
    )


def truth(frequency):
    names = ("loss_factor", "onset_amplitude", "kn", "kt")
    return xr.Dataset({"frequency": frequency, **dict.fromkeys(names, 1.0)})


def test_score_counts_what_hits_within_three_standard_errors():
    measured = stick([500.2, 501.0, np.nan], [0.1, 0.1, np.nan], [1, 1, 0])
    result = score(measured, {f"r{i}": truth(500.0) for i in range(3)})
    np.testing.assert_allclose(result["deviation"], [2.0, 10.0, np.nan], rtol=1e-9)
    assert (result.attrs["reached"], result.attrs["within_3"]) == (2, 1)


def test_a_record_without_truth_is_named():
    with pytest.raises(ValueError, match="no truth for record r1"):
        score(stick([1.0, 1.0], [1.0, 1.0], [1, 1]), {"r0": truth(1.0)})
