"""What the simulation gets wrong, why, and what the cause is worth -> diagnosis, verdict, model."""

import json

import yaml
from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.dataset import dataset
from bladeroot.diagnosis.diagnose import Settings, diagnose, with_lower_forces
from bladeroot.diagnosis.extension import model_file
from bladeroot.diagnosis.next_measurement import next_measurements
from bladeroot.diagnosis.verdict import verdict as verdict_of
from bladeroot.mechanisms.catalogue import usable_catalogue

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
    given = (seen, artifacts.load(parametric))
    candidates, failed = usable_catalogue(asked.get("mechanisms") or None)
    made = diagnose(*given, told, candidates)
    every = with_lower_forces(*given, told, candidates)
    whole = dataset(made, every).merge(next_measurements(made))
    whole.attrs["mechanisms_not_tried"] = "; ".join(failed)
    artifacts.save(whole, diagnosis, origin=seen, settings=settings)
    artifacts.save_json(verdict_of(made, every), verdict)
    if model:
        artifacts.save_text(yaml.safe_dump(model_file(made), sort_keys=False), model)


if __name__ == "__main__":
    run(
        main,
        observations="observations.nc",
        parametric="parametric.nc of the structure",
        settings="section `diagnosis`, the model's bias, full_contact_from_kN (JSON)",
        diagnosis="diagnosis file",
        verdict="verdict file (JSON)",
        model="optional: model file of the extension (YAML)",
    )
