"""What the simulation gets wrong, why, and what the cause is worth -> diagnosis, verdict, model."""

import json
from pathlib import Path

import yaml
from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.judged import judge
from bladeroot.files import save_text
from bladeroot.io.load import Load
from bladeroot.io.table import read_table
from bladeroot.mechanisms.catalogue import usable_catalogue


def main(observations, parametric, settings, diagnosis, verdict, model):
    seen, asked = artifacts.load(observations), json.loads(settings)
    candidates, failed = usable_catalogue(asked.get("mechanisms") or None)
    simulation = None
    if parametric and parametric[0].endswith(".csv"):
        load = Load(**asked["load"]) if asked["load"] else None
        simulation = read_table(Path(parametric[0]), {"modes": asked["expected_Hz"]}, load)
    elif parametric:
        simulation = artifacts.load(parametric[0])
    whole, said, extension = judge(seen, simulation, asked, candidates)
    whole.attrs["mechanisms_not_tried"] = "; ".join(failed)
    artifacts.save(whole, diagnosis, origin=seen, settings=settings)
    artifacts.save_json(said, verdict)
    if model:
        text = yaml.safe_dump(extension, sort_keys=False) if extension else ""
        save_text(text, model)


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
