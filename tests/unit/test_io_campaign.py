"""Every fault of a campaign's files is one line that names file and row."""

from pathlib import Path

import numpy as np
import pytest
from bladeroot.io.campaign import CampaignError, load_campaign
from bladeroot.io.facts import diagnosis_facts, record_facts
from bladeroot.io.load import force_scale, load_facts
from bladeroot.io.outliers import outliers
from bladeroot.io.read import read
from bladeroot.io.stick_rows import stick_table
from bladeroot.loads import shown
from bladeroot.pooling.stick_table import stick_from_table

ROOT = Path(__file__).resolve().parents[2]

DESCRIPTION = """
title: a test
structure: [dovetail-HB]
modes:
  1B: {expected_Hz: 540, laser_x_mm: 0}
  2B: {expected_Hz: 1450, laser_x_mm: 40}
force: {gauge: pressure, piston_area_cm2: 17.9, full_scale_bar: 700, accuracy_percent: 1,
        accuracy_of: full-scale}
"""
HEADER = "record,file,mode,pressure_bar,hold,direction,time_s,quantity,unit,exclude\n"
GOOD = "r1,r1.nc,1B,20,h1,up,0,velocity,mm/s,\n"
STICK = "mode,force_N,frequency_Hz,frequency_std_Hz,loss_factor,loss_factor_std\n"


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "camp"
    folder.mkdir()
    (folder / "campaign.yaml").write_text(DESCRIPTION)
    (folder / "r1.nc").write_bytes(b"raw")
    return folder


def faults(folder, sheet, text):
    (folder / sheet).write_text(text)
    with pytest.raises(CampaignError) as caught:
        load_campaign(folder)
    return str(caught.value).splitlines()


def test_a_good_sheet_is_read_in_si_units(folder):
    (folder / "records.csv").write_text(HEADER + GOOD + "r2,r1.nc,2B,10,,down,,,,yes\n")
    campaign = load_campaign(folder)
    assert campaign.excluded == ("r2",)
    (record,) = campaign.records
    assert record["force_N"] == pytest.approx(20 * 179.0)
    assert (record["unit"], record["hold"], record["time_s"]) == ("mm/s", "h1", 0.0)
    assert campaign.load.full_scale == pytest.approx(125300.0)


def test_the_published_campaign_is_good():
    campaign = load_campaign(ROOT / "resources" / "campaigns" / "thesis")
    assert [row["mode"] for row in campaign.stick].count("1B") == 10
    assert [row["mode"] for row in campaign.stick].count("2B") == 27


def test_every_published_force_is_a_whole_number_of_bars():
    # The argument that the piston measures 17.9 cm^2 where the text prints mm^2.
    campaign = load_campaign(ROOT / "resources" / "campaigns" / "thesis")
    for row in campaign.stick:
        assert (row["force_N"] / 179) == pytest.approx(round(row["force_N"] / 179), abs=1e-9)


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("r1,r9.nc,1B,20,h1,up,0,velocity,mm/s,", "file not found: r9.nc"),
        (
            "r1,r1.xyz,1B,20,h1,up,0,velocity,mm/s,",
            ".mat, .nc, .nc4, .tdms, .tsv, .txt, .u58, .uff, .unv, .wav, .wave, got 'r1.xyz'",
        ),
        ("r1,r1.nc,1B,2_0,h1,up,0,velocity,mm/s,", "must be a finite number, got '2_0'"),
        ("r1,,1B,20,h1,up,0,velocity,mm/s,", "file is missing"),
        ("r1,r1.nc,1B,20,h1,up,0,velocity,furlong,", "expected a unit such as m/s, mm/s"),
        ("r1,r1.nc,1B,20,h1,up,0,velocity,mm,", "unit of velocity must be one such as m/s, mm/s"),
        ("r1,r1.nc,1B,20,h1,up,0,,V,", "unit V needs a sensitivity such as 125 mm/s/V"),
        ("r1,r1.nc,1B,20,h1,up,0,speed,m/s,", "quantity must be velocity or"),
        (
            "r1,r1.nc,1B,nan,h1,up,0,velocity,m/s,",
            "pressure_bar must be a finite number, got 'nan'",
        ),
        ("r1,r1.nc,1B,twenty,h1,up,0,velocity,m/s,", "must be a finite number, got 'twenty'"),
        ("r1,r1.nc,1B,-3,h1,up,0,velocity,m/s,", "pressure_bar must be positive, got -3"),
        (
            "r1,r1.nc,1B,701,h1,up,0,velocity,m/s,",
            "pressure_bar 701 lies outside the gauge's range",
        ),
        ("r1,r1.nc,1B,,h1,up,0,velocity,m/s,", "expected force_N or pressure_bar, got neither"),
        ("r1,r1.nc,3B,20,h1,up,0,velocity,m/s,", "mode must be one of 1B, 2B (campaign.yaml)"),
        ("r1,r1.nc,1B,20,h1,left,0,velocity,m/s,", "direction must be up or down, got 'left'"),
        ("r1,r1.nc,1B,20,h1,up,inf,velocity,m/s,", "time_s must be a finite number, got 'inf'"),
        ("r 1,r1.nc,1B,20,h1,up,0,velocity,m/s,", "record must be letters, digits, - and _"),
        ("r1,r1.nc,1B,20,h1,up,0,velocity,m/s,maybe", "exclude must be yes or no, got 'maybe'"),
        ("r1,r1.nc,1B,20,h1", "expected 10 cells, got 5"),
    ],
)
def test_a_bad_record_is_one_line_with_file_and_row(folder, row, told):
    (line,) = faults(folder, "records.csv", HEADER + "r0,r1.nc,1B,20,h1,up,0,velocity,m/s,\n" + row)
    assert told in line
    assert line.endswith(f"({folder / 'records.csv'}, row 3)")


@pytest.mark.parametrize("sensitivity", ["fast", "0 mV/g", "12 furlong/V"])
def test_a_sensitivity_is_checked_where_the_file_has_the_unit(folder, sensitivity):
    header = "record,file,mode,pressure_bar,sensitivity\n"
    (line,) = faults(folder, "records.csv", f"{header}r1,r1.nc,1B,20,{sensitivity}\n")
    assert "expected a" in line
    assert line.endswith(f"({folder / 'records.csv'}, row 2)")


def test_a_simulated_record_lies_where_the_bench_puts_it(folder):
    (folder / "campaign.yaml").write_text(DESCRIPTION + "bench: bench.yaml\n")
    (line,) = faults(folder, "records.csv", HEADER + GOOD.replace("r1.nc", "other.nc"))
    assert "file of a simulated record must be r1.nc, got 'other.nc'" in line


def test_two_rows_of_one_id(folder):
    (line,) = faults(folder, "records.csv", HEADER + GOOD + GOOD)
    assert "record 'r1' stands in row 2 already" in line
    assert "row 3" in line


def test_two_stick_frequencies_of_one_force(folder):
    row = "1B,3580,540,0.1,0.004,0.0002\n"
    (line,) = faults(folder, "stick.csv", STICK + row + row.replace("3580", " 3580.0"))
    assert "mode 1B at 3580 N stands in row 2 already" in line


def test_names_that_results_uses_are_refused(folder):
    with pytest.raises(CampaignError, match="must not be named bench"):
        load_campaign(folder.rename(folder.parent / "bench"))


def test_all_faults_are_told_at_once(folder):
    rows = "r1,r9.nc,1B,20,h1,up,0,velocity,m/s,\nr2,r1.nc,9B,20,h1,up,0,velocity,m/s,\n"
    assert len(faults(folder, "records.csv", HEADER + rows)) == 2


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("1B,3580,-3.2,0.1,0.004,0.0002", "frequency_Hz must be positive, got -3.2"),
        ("1B,3580,540,nan,0.004,0.0002", "frequency_std_Hz must be a finite number, got 'nan'"),
        ("1B,200000,540,0.1,0.004,0.0002", "force_N 200000 lies outside the gauge's range"),
        ("2B,3580,540,0.1,0.004,0.0002", "frequency_Hz 540 is not in the band of mode 2B"),
    ],
)
def test_a_bad_stick_frequency_is_one_line_with_file_and_row(folder, row, told):
    (line,) = faults(folder, "stick.csv", STICK + row + "\n")
    assert told in line
    assert line.endswith(f"({folder / 'stick.csv'}, row 2)")


@pytest.mark.parametrize(
    ("sheet", "text", "told"),
    [
        ("records.csv", "", "the sheet is empty"),
        ("records.csv", HEADER, "no usable row"),
        ("records.csv", "record,file\nr1,r1.nc\n", "missing column 'mode'"),
        ("records.csv", HEADER.replace("hold", "hlod") + GOOD, "unknown column 'hlod'"),
        ("records.csv", HEADER.replace("hold", "file") + GOOD, "column 'file' stands twice"),
        ("stick.csv", "mode,force_N\n1B,3580\n", "missing column 'frequency_Hz'"),
    ],
)
def test_a_bad_sheet(folder, sheet, text, told):
    (line,) = faults(folder, sheet, text)
    assert told in line
    assert sheet in line


def test_a_sheet_that_is_not_text(folder):
    (folder / "records.csv").write_bytes(b"\xff\xfe\x00record")
    with pytest.raises(CampaignError, match="not utf-16 text"):
        load_campaign(folder)


def test_both_sheets_or_none(folder):
    with pytest.raises(CampaignError, match=r"expected records\.csv or stick\.csv"):
        load_campaign(folder)
    (folder / "records.csv").write_text(HEADER + GOOD)
    (folder / "stick.csv").write_text(STICK)
    with pytest.raises(CampaignError, match=r"found records.csv and stick.csv"):
        load_campaign(folder)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("expected_Hz: 540", "expected_Hz: 5.4e2", "modes.1B.expected_Hz"),
        ("expected_Hz: 1450", "expected_Hz: 540", "1B and 2B have the same expected_Hz, 540"),
        ("expected_Hz: 1450", "expected_Hz: 540.0", "1B and 2B have the same expected_Hz, 540"),
        ("expected_Hz: 540", "expected_Hz: [[9, 500], [3, 560]]", "loads in rising order"),
        ("expected_Hz: 540", "expected_Hz: [[3, 500]]", "modes.1B.expected_Hz"),
        ("full_scale_bar: 700", "full_scale_bar: -1", "force"),
        ("title: a test", "titel: a test", "titel"),
        ("structure: [dovetail-HB]", "structure: []", "structure"),
        ("title: a test", "title: [", "not a YAML text"),
    ],
)
def test_a_bad_description_names_the_key(folder, old, new, told):
    # YAML reads 5.4e2 as text: the schema catches what would be a silent slip.
    (folder / "campaign.yaml").write_text(DESCRIPTION.replace(old, new))
    lines = faults(folder, "records.csv", HEADER + GOOD)
    assert any(told in line and "campaign.yaml" in line for line in lines)


def test_an_empty_raw_file_is_left_to_its_own_job(folder):
    """It is left out there with its reason, as any other bad file."""
    (folder / "r1.nc").write_bytes(b"")
    (folder / "records.csv").write_text(HEADER + GOOD)
    assert len(load_campaign(folder).records) == 1
    with pytest.raises(ValueError, match="empty file"):
        read(folder / "r1.nc")


def test_strain_gauge_force_per_microstrain():
    gauge = {"gauge": "strain", "section_mm2": 260, "modulus_GPa": 210}
    assert force_scale(gauge) == pytest.approx(54.6)


ROWS = [
    "record|file|mode|force_N|sensitivity|sampling_Hz|unit|quantity|Notes by Jörg",
    "r1|r1.nc|1B|3580.5|0.125 m/s/V|25600.5|V|velocity|größer, später",
    "r2|r1.nc|1B|7160.0|100 mV/g|25600.5|V||",
]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
@pytest.mark.parametrize(
    ("separator", "decimal"), [(";", ","), (";", "."), ("\t", "."), (",", ".")]
)
def test_sheets_as_labs_save_them(folder, encoding, separator, decimal):
    text = "\r\n".join(ROWS).replace("größer, später", "größer")
    text = text.replace("|", separator).replace("3580.5", f"3580{decimal}5")
    text = text.replace("25600.5", f"25600{decimal}5")
    (folder / "records.csv").write_bytes((text + separator * 2 + "\r\n").encode(encoding))
    first, second = load_campaign(folder).records
    assert (first["force_N"], first["sampling_Hz"]) == (3580.5, 25600.5)
    assert (first["unit"], first["sensitivity"]) == ("V", "0.125 m/s/V")
    assert second["force_N"] == 7160.0


def test_a_column_that_is_no_remark_is_named(folder):
    (line,) = faults(
        folder, "records.csv", "record,file,mode,force_N,operator\nr1,r1.nc,1B,3580,x\n"
    )
    assert "unknown column 'operator'" in line
    assert "or note... for remarks" in line


@pytest.mark.parametrize(
    ("loads", "told"),
    [
        (("7,160", "3,580"), "got '7,160', whose comma may be that or a decimal one"),
        (("7160,5", "3.580"), "expected one decimal sign, got '7160,5' and '3.580'"),
        (("7160,5", "3,580"), None),
        (("7160,5", "3580.0"), None),
        (("7160.5", "13.580"), None),
    ],
)
def test_a_sign_that_may_stand_between_thousands_is_a_fault(folder, loads, told):
    rows = (f"r{k};r1.nc;1B;{load};b{k}" for k, load in enumerate(loads))
    text = "\n".join(["record;file;mode;force_N;hold", *rows, ""])
    if told:
        (line,) = faults(folder, "records.csv", text)
        assert told in line
        assert "records.csv, row" in line
    else:
        (folder / "records.csv").write_text(text)
        assert load_campaign(folder).records[0]["force_N"] == float(loads[0].replace(",", "."))


def test_a_decimal_comma_between_commas_is_a_fault(folder):
    (line,) = faults(folder, "records.csv", "record,file,mode,force_N\nr1,r1.nc,1B,3580,5\n")
    assert "expected 4 cells, got 5" in line


def test_one_structure_is_a_plain_name(folder):
    text = DESCRIPTION.replace("[dovetail-HB]", "dovetail-HB")
    (folder / "campaign.yaml").write_text(text)
    (folder / "records.csv").write_text(HEADER + GOOD)
    campaign = load_campaign(folder)
    assert campaign.description["structure"] == ["dovetail-HB"]
    assert campaign.warnings == ()


def test_without_a_structure_the_measurement_stands_alone(folder):
    text = DESCRIPTION.replace("structure: [dovetail-HB]\n", "")
    (folder / "campaign.yaml").write_text(text)
    (folder / "records.csv").write_text(HEADER + GOOD)
    assert load_campaign(folder).description["structure"] == []
    (folder / "campaign.yaml").write_text(text + "published: thesis\n")
    with pytest.raises(CampaignError, match="'structure' is a dependency of 'published'"):
        load_campaign(folder)


def test_slips_are_warnings(folder):
    text = "record,file,mode,force_N\nr1,r1.nc,1B,12\nr2,r1.nc,1B,12000\n"
    (folder / "records.csv").write_text(text)
    kilo, twice = load_campaign(folder).warnings
    assert "force_N 12 is 12 N on a gauge of 125300 N: kN given as N?" in kilo
    assert kilo.endswith("records.csv, row 2)")
    assert "file r1.nc stands in row 2 already" in twice


def test_readings_in_place_of_nominal_forces_are_a_warning(folder):
    rows = "".join(f"r{k},r1.nc,1B,{12000 + k},{k}\n" for k in range(4))
    text = "record,file,mode,force_N,channel\n" + rows + "r9,r1.nc,2B,12500,1\n"
    (folder / "records.csv").write_text(text)
    (line,) = load_campaign(folder).warnings
    assert "1B: 4 forces lie less than 1 % apart, as 12000 and 12001 N" in line
    assert line.endswith("records.csv, row 2)")


def test_one_file_may_hold_two_modes_or_channels(folder):
    text = "record,file,mode,force_N,channel\nr1,r1.nc,1B,12000,1\nr2,r1.nc,2B,12000,1\n"
    (folder / "records.csv").write_text(text + "r3,r1.nc,1B,12000,2\n")
    assert load_campaign(folder).warnings == ()


def test_a_channel_with_a_comma_stands_in_quotes(folder):
    text = 'record,file,mode,force_N,channel\nr1,r1.nc,1B,12000,"xData{3,2}"\n'
    (folder / "records.csv").write_text(text)
    assert load_campaign(folder).records[0]["channel"] == "xData{3,2}"


def thesis_table(**changed):
    """The published frequencies of 2B by force, some of them changed."""
    campaign = load_campaign(ROOT / "resources" / "campaigns" / "thesis")
    rows = {f"{row['force_N']:g}": row for row in campaign.stick if row["mode"] == "2B"}
    lines = [
        f"2B,{force},{changed.get(f'at_{force}', row['frequency_Hz'])},0.1,0.004,0.0001\n"
        for force, row in rows.items()
    ]
    return STICK + "".join(lines), list(rows)


def test_a_wrong_digit_in_the_stick_table_is_a_warning(folder):
    text, forces = thesis_table(at_12172=1095.92)
    (folder / "stick.csv").write_text(text)
    campaign = load_campaign(folder)
    (line,) = campaign.warnings
    assert line.startswith("frequency_Hz 1095.92 of 2B at 12172 N lies far from 14")
    assert line.endswith(f"({folder / 'stick.csv'}, row {forces.index('12172') + 2})")
    assert len(campaign.stick) == len(forces)  # nothing is left out


def test_the_published_frequencies_stand_together():
    assert load_campaign(ROOT / "resources" / "campaigns" / "thesis").warnings == ()


@pytest.mark.parametrize("k", [0, 4, 9])
def test_a_lone_frequency_is_found_also_at_the_ends(k):
    force = np.geomspace(2e3, 24e3, 10)
    frequency = 500.0 * (force / 24e3) ** 0.05
    frequency[k] *= 0.8
    ((row, expected),) = outliers(force, frequency)
    assert row == k
    assert expected == pytest.approx(frequency[k] / 0.8, rel=0.05)


def test_a_law_that_bends_has_no_lone_frequency():
    """Contact that is not full below 4 kN: steep there, flat above."""
    force = np.array([1.8e3, 2.5e3, 3.6e3, 5.4e3, 7.2e3, 12e3, 18e3, 24e3])
    frequency = 500.0 * (force / 24e3) ** 0.01 * np.minimum(force / 4e3, 1.0) ** 0.5
    assert outliers(force, frequency) == []
    assert outliers(force[:5], np.array([400.0, 500.0, 600.0, 500.0, 400.0])) == []  # too few


def test_a_stick_table_is_read_as_it_was_checked(folder):
    """Semicolons, decimal commas, empty columns at the right and a remark: one reader for both."""
    text = STICK.replace(",", ";").rstrip() + ";note a;\n"
    text += "1B;3580,5;520,1;0,1;0,004;0,0001;second;\n;;;;;;;\n"
    (folder / "stick.csv").write_text(text, encoding="utf-16")
    campaign = load_campaign(folder)
    assert campaign.stick[0]["force_N"] == 3580.5
    stick = stick_from_table(stick_table(folder / "stick.csv", campaign.load))
    assert stick["force"].values.tolist() == [3580.5]
    assert stick["frequency"].values.ravel().tolist() == [520.1]


@pytest.mark.parametrize(
    ("said", "column", "kept"),
    [
        ("{name: clamping force, unit: kN}", "load", 3500.0),
        ("{name: clamping force, unit: kN}", "force_kN", 3500.0),
        ("{name: clamping force, unit: kN}", "force_N", 3.5),
        ("{name: torque, unit: Nm}", "torque_Nm", 3.5),
    ],
)
def test_a_stick_table_has_the_load_of_its_campaign(folder, said, column, kept):
    description = f"title: a\nload: {said}\nmodes:\n  1B: {{expected_Hz: 540}}\n"
    (folder / "campaign.yaml").write_text(description)
    text = STICK.replace("force_N", column) + "1B,3.5,520,0.1,0.004,0.0001\n"
    (folder / "stick.csv").write_text(text)
    campaign = load_campaign(folder)
    assert campaign.stick[0]["load"] == kept
    table = stick_table(folder / "stick.csv", campaign.load)
    stick = stick_from_table(table, load=load_facts(campaign.load))
    assert stick["force"].values.tolist() == [kept]
    _, unit, name = shown(stick.attrs)
    assert said == f"{{name: {name}, unit: {unit}}}"


def test_a_stick_table_of_another_load_is_told_what_is_asked_for(folder):
    rows = "1B,3.5,520,0.1,0.004,0.0001\n"
    (line,) = faults(folder, "stick.csv", STICK.replace("force_N", "torque_Nm") + rows)
    assert "torque_Nm is in Nm, the load of campaign.yaml (axial force) in N" in line
    (line,) = faults(folder, "stick.csv", STICK.replace("force_N,", "") + rows.replace("3.5,", ""))
    assert "expected force_N or" in line
    description = "title: a\nmodes:\n  1B: {expected_Hz: 540}\n"
    (folder / "campaign.yaml").write_text(description)
    (line,) = faults(folder, "stick.csv", STICK + rows)
    assert "needs a load in campaign.yaml" in line


OWN = "title: a\nload: {name: torque, unit: Nm}\nmodes:\n  B1: {expected_Hz: 60}\n"
OWN_HEADER = "record,file,mode,load,sensor,channel,band_Hz\n"


def own(folder, description, row="r1,r1.nc,B1,1,,,"):
    (folder / "campaign.yaml").write_text(description)
    (folder / "records.csv").write_text(f"{OWN_HEADER}{row}\n")
    return load_campaign(folder)


def test_a_mode_may_be_called_by_a_number_or_a_word_of_yaml(folder):
    for name in ("1", "on", "no", "1.5"):
        text = OWN.replace("B1", name)
        if "." in name:
            with pytest.raises(CampaignError):
                own(folder, text, f"r1,r1.nc,{name},1,,,")
        else:
            made = own(folder, text, f"r1,r1.nc,{name},1,,,")
            assert list(made.description["modes"]) == [name]


def test_what_stands_twice_or_has_a_decimal_comma_is_told(folder):
    with pytest.raises(CampaignError, match=r"'B1' in line 5 stands in line 4 already"):
        own(folder, f"{OWN}  B1: {{expected_Hz: 320}}\n")
    with pytest.raises(CampaignError, match="decimal comma"):
        own(folder, OWN.replace("60", "60,5"))


def test_a_sensor_has_its_channel_and_a_band_holds_its_mode(folder):
    sensors = "sensors:\n  tip: {channel: Acc tip}\n  root: {channel: 3}\n"
    made = own(folder, OWN + sensors, "r1,r1.nc,B1,1,tip root,,40-80")
    assert [(one["sensor"], one["channel"]) for one in made.records] == [
        ("tip", "Acc tip"), ("root", "3"),
    ]  # fmt: skip
    with pytest.raises(CampaignError, match=r"band_Hz must hold the 60 Hz of B1.*row 2"):
        own(folder, OWN, "r1,r1.nc,B1,1,,,70-90")


def test_a_mode_is_expected_where_the_load_takes_it(folder):
    text = """
title: a string between two beams
modes: {low: {expected_Hz: [[2, 100], [6, 180]]}, high: {expected_Hz: 200}}
load: {name: tension, unit: kN, accuracy_percent: 1, accuracy_of: reading}
"""
    (folder / "campaign.yaml").write_text(text)
    rows = [f"r{k},r1.nc,{mode},{at}" for k, (mode, at) in enumerate([("low", 3), ("high", 9)])]
    (folder / "records.csv").write_text("record,file,mode,load\n" + "\n".join(rows) + "\n")
    campaign = load_campaign(folder)
    low, high = (record_facts(campaign, row) for row in campaign.records)
    assert (low["expected_Hz"], low["other_modes_Hz"]) == (120.0, [200.0])
    assert (high["expected_Hz"], high["other_modes_Hz"]) == (200.0, [180.0])
    middle = diagnosis_facts(campaign, {"diagnosis": {}, "search": {}})["expected_Hz"]
    assert middle == pytest.approx({"low": np.sqrt(100.0 * 180.0), "high": 200.0})
    (folder / "campaign.yaml").write_text(text[: text.index("load:")])
    (folder / "records.csv").write_text("record,file,mode\nr1,r1.nc,low\n")
    with pytest.raises(CampaignError, match="expected_Hz over a load needs a load"):
        load_campaign(folder)
