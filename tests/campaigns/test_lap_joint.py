"""The shipped campaign of a lap joint, on a coarse mesh, from raw records to its verdict."""

import json
import re

import numpy as np
import pytest
import xarray as xr
import yaml
from house import copy_house
from lap_coarse import COARSE

LAP = "resources/structures/lap-joint.yaml"
SHEET = "resources/campaigns/lap-joint/records.csv"


@pytest.mark.slow
def test_a_lap_joint_of_three_modes_at_four_preloads(tmp_path):
    house = copy_house(tmp_path / "house")
    file = house.folder / LAP
    coarse = yaml.safe_load(file.read_text()) | {"mesh": COARSE, "reduction": {"modes": 8}}
    file.write_text(yaml.safe_dump(coarse, sort_keys=False))
    house.edit("resources/bench/lap-joint.yaml", "modes: 24", "modes: 12")  # the bench moves fewer
    rows = (house.folder / SHEET).read_text().splitlines()
    up = [row for row in rows if ",up," in row]
    (house.folder / SHEET).write_text("\n".join([rows[0], *up]) + "\n")
    assert len(up) == 12
    house.run("--config", "campaigns=lap-joint")
    results = house.folder / "results" / "lap-joint"
    stick = xr.load_dataset(results / "stick.nc")
    assert set(stick["mode"].values.astype(str)) == {"bend1", "bend2", "bend3"}
    seen = xr.load_dataset(results / "observations.nc")
    assert np.unique(seen["force"].values).size == 4
    said = json.loads((results / "diagnosis" / "verdict.json").read_text())
    assert said["structure"] == "lap-joint"
    # of the bench, whose stiffness goes with the root of the preload; no other is said to be there
    shown = [one for one in said["causes"] if one["shown"]]
    assert {one["mechanism"] for one in shown} <= {"load-dependent-stiffness"}
    assert {"load-dependent-stiffness", "incomplete-contact"} & set(said["possible"])
    pages = [results / "report.html", *(results / "report").glob("*.html")]
    text = " ".join(re.sub(r"<(script|style).*?</\1>|<[^>]+>", " ", page.read_text(), flags=re.S)
                    for page in pages)  # fmt: skip
    assert "bolt preload" in text
    assert not re.search(r"\b(dovetail|flanks?|slots?|axial)\b", text)
