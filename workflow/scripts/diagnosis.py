"""What the simulation gets wrong, why, and what the cause is worth -> diagnosis, verdict, model."""

import json
from pathlib import Path

import yaml
from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis import judged
from bladeroot.diagnosis.diagnose import Settings
from bladeroot.diagnosis.simulation.table import table_of
from bladeroot.mechanisms.catalogue import usable_catalogue
from bladeroot.records.load import Load
from bladeroot.records.table import read_table

BIAS_PERCENT = {"1B": 0.5, "2B": 0.5}


def main(observations, parametric, settings, diagnosis, verdict, model):
    seen, asked = artifacts.load(observations), json.loads(settings)
    bias, offset = (
        {mode: percent / 100 for mode, percent in asked.get(name, usual).items()}
        for name, usual in (("fe_bias_percent", BIAS_PERCENT), ("fe_offset_percent", {}))
    )
    splits = {
        one["measurement"]: (one["value"], one["std"]) for one in asked.get("independent", [])
    }
    told = Settings(bias, offset, 1000.0 * asked.get("full_contact_from_kN", 0.0), splits)
    candidates, failed = usable_catalogue(asked.get("mechanisms") or None)
    expected = asked.get("expected_Hz", {})
    if not parametric:
        made = judged.with_baseline(seen, told, candidates, expected)
    elif parametric[0].endswith(".csv"):
        load = Load(**asked["load"]) if asked["load"] else None
        rows = read_table(Path(parametric[0]), {"modes": expected}, load)
        table = table_of(rows, Path(parametric[0]).name, {"": 0.005} | bias, offset)
        made = judged.with_table(seen, table, told, candidates)
    else:
        structure = artifacts.load(parametric[0])
        lacks = asked.get("structure_lacks", "")
        made = judged.with_structure(seen, structure, told, candidates, expected, lacks)
    whole, said, extension = made
    whole.attrs["mechanisms_not_tried"] = "; ".join(failed)
    artifacts.save(whole, diagnosis, origin=seen, settings=settings)
    artifacts.save_json(said, verdict)
    if model:
        text = yaml.safe_dump(extension, sort_keys=False) if extension else ""
        artifacts.save_text(text, model)


if __name__ == "__main__":
    run(
        main,
        observations="observations.nc",
        parametric="any: parametric.nc of the structure, or a table (CSV); without, linear modes",
        settings="section `diagnosis`, the model's bias, full_contact_from_kN (JSON)",
        diagnosis="diagnosis file",
        verdict="verdict file (JSON)",
        model="optional: model file of the extension (YAML)",
    )
