"""Campaigns of any specimen: modes, loads, sensors, events and groups as data."""

import numpy as np
import pytest
from bladeroot.io.campaign import CampaignError, load_campaign
from bladeroot.io.facts import observation_facts
from bladeroot.io.load import Load
from bladeroot.io.table import read_table
from bladeroot.loads import shown, value_of

BARE = """
title: three floors
modes:
  first: {expected_Hz: 7}
  second: {expected_Hz: 19.4}
"""
TABLE = "time_s,top,middle,run A\n" + "\n".join(f"{k / 100},{k % 7},{k % 5},1" for k in range(80))


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "floors"
    folder.mkdir()
    (folder / "campaign.yaml").write_text(BARE)
    for name in ("a.csv", "b.csv"):
        (folder / name).write_text(TABLE)
    return folder


def loaded(folder, sheet, more=""):
    (folder / "campaign.yaml").write_text(BARE + more)
    (folder / "records.csv").write_text(sheet)
    return load_campaign(folder)


def fault(folder, sheet, more=""):
    with pytest.raises(CampaignError) as caught:
        loaded(folder, sheet, more)
    (line,) = str(caught.value).splitlines()
    return line


def test_nothing_but_expected_frequencies_is_needed(folder):
    campaign = loaded(folder, "record,file,mode\nr1,a.csv,first\n")
    (row,) = campaign.records
    assert campaign.load is None
    assert (row["load"], row["force_N"], row["hold"], row["event"]) == (0.0, None, "r1", "")
    assert campaign.description["simulation"] == "none"
    assert campaign.description["structure"] == []


def test_a_row_of_several_modes_and_channels_is_one_event(folder):
    campaign = loaded(
        folder,
        "record,file,mode,channel,group\nr1,a.csv,all,top;middle,roof\nr2,b.csv,first,top,\n",
    )
    assert [row["record"] for row in campaign.records] == [
        "r1-first-top", "r1-first-middle", "r1-second-top", "r1-second-middle", "r2",
    ]  # fmt: skip
    assert {row["event"] for row in campaign.records[:4]} == {"r1"}
    assert {row["hold"] for row in campaign.records[:4]} == {"r1"}  # not repeats of each other
    assert [row["sensor"] for row in campaign.records[:2]] == ["top", "middle"]
    assert campaign.records[4]["event"] == ""


@pytest.mark.parametrize(
    ("cell", "channels"),
    [
        ("top middle", ["top", "middle"]),
        ("1 2", ["1", "2"]),
        ("run A", ["run A"]),
        ("top | middle", ["top", "middle"]),
    ],
)
def test_a_channel_with_a_blank_in_its_name_stays_one(folder, cell, channels):
    campaign = loaded(folder, f"record,file,mode,channel\nr1,a.csv,first,{cell}\n")
    assert [row["channel"] for row in campaign.records] == channels


def test_a_row_of_several_modes_of_one_channel(folder):
    campaign = loaded(folder, 'record,file,mode,channel\nr1,a.csv,"first, second",top\n')
    assert [row["record"] for row in campaign.records] == ["r1-first", "r1-second"]


def test_a_name_that_cannot_be_is_refused_in_words(folder):
    told = fault(folder, "record,file,mode\nr1,a.csv,first\n", "sensors: {laser z: {z_mm: 3}}\n")
    assert "sensors: 'laser z'" in told
    assert "letters, digits, _ and -" in told


def test_sensors_have_their_channels_and_places(folder):
    more = "sensors:\n  roof: {channel: top, x_mm: 0, z_mm: 600}\n  floor: {channel: middle}\n"
    sheet = "record,file,mode,channel\nr1,a.csv,first,top middle\n"
    campaign = loaded(folder, sheet, more)
    assert [row["sensor"] for row in campaign.records] == ["roof", "floor"]
    assert campaign.laser_x("first") == 0.0
    sheet = "record,file,mode,channel,sensor\nr1,a.csv,first,top,celler\n"
    assert "sensor must be one of roof, floor" in fault(folder, sheet, more)


@pytest.mark.parametrize(
    ("load", "column", "cell", "value"),
    [
        ("{name: bolt torque, unit: Nm, gauge: torque wrench, full_scale: 50, "
         "accuracy_percent: 4, accuracy_of: reading}", "torque_Nm", "12.5", 12.5),
        ("{name: preload, unit: kN, accuracy: 0.2}", "load", "5", 5000.0),
        ("{name: preload, unit: kN}", "preload_N", "5", 5.0),
        ("{name: temperature, unit: C, accuracy: 0.5}", "temperature_C", "-20", -20.0),
        ("{name: speed, unit: rpm}", "speed_rpm", "0", 0.0),
        ("{name: axial force, unit: N, gauge: pressure, piston_area_cm2: 17.9, "
         "full_scale_bar: 700, accuracy_percent: 1}", "pressure_bar", "10", 1790.0),
    ],
)  # fmt: skip
def test_loads_of_any_name_and_unit(folder, load, column, cell, value):
    sheet = f"record,file,mode,{column}\nr1,a.csv,first,{cell}\n"
    campaign = loaded(folder, sheet, f"load: {load}\n")
    assert campaign.records[0]["load"] == pytest.approx(value)


@pytest.mark.parametrize(
    ("load", "told"),
    [("speed, unit: rpm", {"r1": 21.5}), ("temperature, unit: C", {})],
)
def test_a_records_temperature_is_told_unless_it_is_the_load(folder, load, told):
    sheet = "record,file,mode,load,temperature_C\nr1,a.csv,first,20,21.5\nr2,a.csv,first,20,\n"
    facts = observation_facts(loaded(folder, sheet, f"load: {{name: {load}}}\n"))
    assert facts["temperature"] == told
    assert facts["time"] == {}


def test_errors_of_a_reading():
    assert Load("torque", "Nm", "", 1.0, 50.0, 0.04, "full-scale").same_everywhere == 2.0
    assert Load("torque", "Nm", "", 1.0, 50.0, 0.04, "reading").of_reading == 0.04
    assert Load("torque", "Nm", "", 1.0, np.inf, 0.3).same_everywhere == 0.3


TORQUE = """
load: {name: bolt torque, unit: Nm, gauge: torque wrench, full_scale: 50, accuracy_percent: 4}
"""


@pytest.mark.parametrize(
    ("columns", "row", "more", "told"),
    [
        ("mode", "third", "", "mode must be one of first, second (campaign.yaml), got 'third'"),
        ("mode", "first third", "", "mode must be of first, second (campaign.yaml), got 'third'"),
        ("mode", "first first", "", "mode names first twice"),
        ("mode,torque_Nm", "first,3", "", "torque_Nm needs a load in campaign.yaml"),
        ("mode,force_N", "first,3", TORQUE, "force_N is in N, the load of campaign.yaml (bolt "),
        ("mode,torque_Nm", "first,60", TORQUE, "torque_Nm 60 lies outside the gauge's range"),
        ("mode,group", "first,a", TORQUE, "expected load or torque_Nm, got neither"),
        ("mode,start_s,end_s", "first,3,2", "", "end_s must lie after start_s, got 2 and 3"),
        ("mode,from_s,to_s", "first,3,3", "", "to_s must lie after from_s, got 3 and 3"),
        ("mode,band_Hz", "first,wide", "", "band_Hz must be two frequencies such as 60-100"),
        ("mode,keep", "first,perhaps", "", "keep must be yes or no, got 'perhaps'"),
    ],
)  # fmt: skip
def test_a_bad_row_is_one_line_with_file_and_row(folder, columns, row, more, told):
    line = fault(folder, f"record,file,{columns}\nr1,a.csv,{row}\n", more)
    assert told in line
    assert line.endswith(f"({folder / 'records.csv'}, row 2)")


def test_a_fault_of_many_rows_is_one_line(folder):
    rows = "".join(f"r{k},a.csv,first,3\n" for k in range(5))
    line = fault(folder, f"record,file,mode,force_N\n{rows}", TORQUE)
    assert line.endswith(f"({folder / 'records.csv'}, row 2 and 4 more)")


@pytest.mark.parametrize(
    ("column", "one", "other"),
    [("time_s", "0", "3"), ("group", "a", "b"), ("sampling_Hz", "100", "200")],
)
def test_rows_of_one_event_must_be_one_motion(folder, column, one, other):
    sheet = f"record,file,mode,event,channel,{column}\nr1,a.csv,first,e,top,{one}\n"
    line = fault(folder, sheet + f"r2,a.csv,first,e,middle,{other}\n")
    assert f"event 'e' is one motion, but {column} is " in line
    assert line.endswith("row 3)")


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("simulation: none\nstructure: dovetail-H\n", "structure and simulation say the same"),
        ("simulation: sim.csv\n", "simulation: file not found: sim.csv"),
        (TORQUE + "structure: own\n", "own.yaml is not beside campaign.yaml and none of the ship"),
        ("load: {name: a, unit: N, accuracy: 1, accuracy_percent: 2}\n", "accuracy and accuracy_"),
        (TORQUE + "structure: dovetail-H\n", "the load's unit must be N or kN, got 'Nm'"),
        ("load: {name: preload, unit: kN, gauge: pressure}\n", "a pressure gauge needs"),
        ("load: {name: preload}\n", "'unit' is a required property"),
        ("load: {name: a, unit: N}\nforce: {gauge: strain, section_mm2: 1, modulus_GPa: 1, "
         "full_scale_microstrain: 1, accuracy_percent: 1, accuracy_of: reading}\n",
         "force and load say the same"),
    ],
)  # fmt: skip
def test_a_bad_description_is_one_line(folder, more, told):
    line = fault(folder, "record,file,mode\nr1,a.csv,first\n", more)
    assert told in line
    assert "campaign.yaml" in line


def test_a_person_may_overrule_a_record(folder):
    sheet = "record,file,mode,start_s,end_s,band_Hz,keep,note\nr1,a.csv,first,0.1,3,5-9,yes,bump\n"
    (row,) = loaded(folder, sheet).records
    assert (row["start_s"], row["end_s"], row["band_Hz"], row["keep"]) == (0.1, 3.0, [5, 9], True)


def test_clamping_is_the_new_name_of_hold(folder):
    sheet = "record,file,mode,clamping\nr1,a.csv,first,c1\n"
    assert loaded(folder, sheet).records[0]["hold"] == "c1"
    assert "clamping and hold" in fault(
        folder, "record,file,mode,clamping,hold\nr1,a.csv,first,c,c\n"
    )


def test_a_load_is_shown_in_its_own_unit():
    assert shown({}) == (1e-3, "kN", "axial force")
    assert shown({"load_name": "bolt torque", "load_unit": "Nm"}) == (1.0, "Nm", "bolt torque")
    assert shown({"load_name": "", "load_unit": ""}) == (1.0, "", "")
    assert [value_of(facts) for facts in ({"load": 3.0}, {"force_N": 2.0}, {})] == [3.0, 2.0, 0.0]


SIMULATED = "mode,torque_Nm,frequency_Hz,by_ln_kn\nfirst,5,7.0,0.01\nfirst,20,7.2,0.01\n"


def with_table(folder, table, sheet="record,file,mode,torque_Nm\nr1,a.csv,first,12\n"):
    (folder / "sim.csv").write_text(table)
    return loaded(folder, sheet, TORQUE + "simulation: sim.csv\n")


@pytest.mark.parametrize("row", ["0.3,0.25", "17.0,3.0", "-0.1,0.2"])
def test_contact_that_carries_more_than_a_mode_is_refused(folder, row):
    table = f"mode,torque_Nm,frequency_Hz,by_ln_kn,by_ln_kt\nfirst,5,7.0,{row}\nfirst,20,7,0.5,0\n"
    (folder / "sim.csv").write_text(table)
    with pytest.raises(ValueError, match=r"between 0 and 0\.5, .* by_ln_kn .* row 2") as told:
        read_table(folder / "sim.csv", {"modes": {"first": {}}}, Load("bolt torque", "Nm"))
    assert "row 3" not in str(told.value)


def test_a_table_is_a_simulation(folder):
    assert with_table(folder, SIMULATED).description["simulation"] == "sim.csv"
    frame = read_table(folder / "sim.csv", {"modes": {"first": {}}}, Load("bolt torque", "Nm"))
    assert frame["load"].tolist() == [5.0, 20.0]
    assert frame["by_ln_kn"].tolist() == [0.01, 0.01]


def test_a_table_may_go_beyond_what_the_gauge_reads(folder):
    with_table(folder, SIMULATED)
    gauge = Load("bolt torque", "Nm", full_scale=10.0)
    frame = read_table(folder / "sim.csv", {"modes": {"first": {}}}, gauge)
    assert frame["load"].tolist() == [5.0, 20.0]


@pytest.mark.parametrize(
    ("table", "sheet", "told"),
    [
        (
            SIMULATED,
            "r1,a.csv,first,30",
            "r1: 30 Nm lies outside the table's loads of mode first, 5",
        ),
        (
            SIMULATED + SIMULATED.split("\n", 1)[1].replace("first", "second"),
            "r1,a.csv,first,30\nr2,a.csv,second,30\nr3,a.csv,second,2",
            "r1 and 2 more: 2, 30 Nm lie outside the table's loads of modes first, second, 5",
        ),
        (
            SIMULATED,
            "r1,a.csv,second,12",
            "r1: the table has no mode second; expected one of first",
        ),
        (
            SIMULATED.replace("7.2", "x"),
            "r1,a.csv,first,12",
            "frequency_Hz must be a finite number",
        ),
        (SIMULATED.replace("20,", "5,"), "r1,a.csv,first,5", "amplitude stands in row 2 already"),
        (
            SIMULATED.replace("first,5", "1B,5"),
            "r1,a.csv,first,12",
            "mode must be one of first, sec",
        ),
        (SIMULATED.replace("frequency_Hz", "f"), "r1,a.csv,first,12", "unknown column 'f'"),
        (
            SIMULATED.replace("torque_Nm", "force_N"),
            "r1,a.csv,first,12",
            "force_N is in N, the load",
        ),
    ],
)
def test_what_a_table_cannot_say_is_one_line(folder, table, sheet, told):
    with pytest.raises(CampaignError) as caught:
        with_table(folder, table, f"record,file,mode,torque_Nm\n{sheet}\n")
    lines = str(caught.value).splitlines()
    assert len(lines) == 1
    assert told in lines[0]
    assert ".csv" in lines[0]


def test_a_table_has_the_same_amplitudes_at_every_load(folder):
    table = (
        "mode,torque_Nm,amplitude_um,frequency_Hz\nfirst,5,1,7\nfirst,5,10,6.9\nfirst,20,1,7.2\n"
    )
    with pytest.raises(CampaignError, match=r"mode first at load 20 has 1 of the table's 2"):
        with_table(folder, table)


def test_a_structure_must_know_where_modes_are_looked_at(folder):
    more = "structure: dovetail-H\nload: {name: axial force, unit: N}\n"
    (folder / "records.csv").write_text("record,file,mode,force_N\nr1,a.csv,1B,3000\n")
    text = "title: a\nmodes:\n  1B: {expected_Hz: 540}\n" + more
    (folder / "campaign.yaml").write_text(text)
    with pytest.raises(CampaignError, match=r"modes\.1B\.laser_x_mm is missing"):
        load_campaign(folder)
    (folder / "campaign.yaml").write_text(text + "sensors: {laser: {x_mm: 30}}\n")
    assert load_campaign(folder).laser_x("1B") == 0.03
    assert load_campaign(folder).structure_lacks == ""


def test_a_structure_that_cannot_be_asked_says_what_lacks(folder):
    campaign = loaded(folder, "record,file,mode\nr1,a.csv,first\n", "structure: dovetail-H\n")
    assert "the campaign states none" in campaign.structure_lacks
    more = "structure: dovetail-H\nload: {name: axial force, unit: kN}\n"
    campaign = loaded(folder, "record,file,mode,load\nr1,a.csv,first,3\n", more)
    assert "a structure knows modes 1B and 2B, not first, second" in campaign.structure_lacks
