"""The parametric model with the matrices that a model file changes -> extended parametric.nc."""

import json

from _cli import run
from bladeroot import artifacts
from bladeroot.diagnosis.extension import read, structure_of
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.schema import read_yaml


def main(parametric, model, settings, output):
    own = json.loads(settings)["mechanisms"]
    extension = read(read_yaml(model, "model"), catalogue(own or None))
    artifacts.save(structure_of(extension, artifacts.load(parametric)), output)


if __name__ == "__main__":
    run(
        main,
        parametric="parametric.nc of the structure",
        model="model file (YAML)",
        settings="section `diagnosis` of the configuration (JSON)",
        output="parametric model of the extended structure",
    )
