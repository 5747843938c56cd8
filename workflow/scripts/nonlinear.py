"""Frequency and damping against amplitude, with friction -> nonlinear/<structure>.nc."""

import json

import numpy as np
import pandas as pd
import xarray as xr
from _cli import run
from bladeroot import artifacts
from bladeroot.contact.punch import punch_from
from bladeroot.diagnosis.extension import amplitude_causes, curves_of, read
from bladeroot.mechanisms.catalogue import catalogue
from bladeroot.nonlinear.backbone import amplitude_ladder, backbone
from bladeroot.nonlinear.flanks import FlankContact
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.schema import read_yaml


def main(reduced, joint, parameters, settings, output, model=None):
    found, asked = artifacts.load(joint), json.loads(settings)
    if found.attrs["law"] == "":  # no stick frequency, no stiffness
        empty = xr.Dataset(attrs={"structure": found.attrs["structure"]})
        artifacts.save(empty, output, origin=found, settings=settings)
        return
    extension = None
    if model:
        extension = read(read_yaml(model, "model"), catalogue(asked["mechanisms"] or None))
        if amplitude_causes(extension):
            asked["law"] = "linear"  # the causes are over a joint that does not slip
    values = pd.read_csv(parameters, index_col="name")["value"].to_dict()
    median = found["k_quantile"].sel(quantile=0.5).transpose("force", "stiffness").values
    points = np.column_stack([np.log(median), found["force"].values])
    pressure = asked["pressure"]
    curves = backbone(
        joint_of_reduced(artifacts.load(reduced)),
        points,
        {mode: x / 1000 for mode, x in asked["laser_x_mm"].items()},
        FlankContact(
            law=asked["law"],
            friction=asked["friction"],
            pressure=0.0 if asked["law"] in ("linear", "iwan") else pressure,
            preload=asked["preload"],
            strips=asked["strips"],
            punch=punch_from(values),
        ),
        amplitude_ladder(*asked["amplitude_um"], asked["amplitudes_per_decade"]),
        asked["method"],
        asked["harmonics"],
        asked["material_loss_factor"],
    )
    if extension is not None:
        curves = curves_of(extension, curves)
    artifacts.save(curves, output, origin=found, settings=settings)


if __name__ == "__main__":
    run(
        main,
        reduced="reduced.nc of the structure",
        joint="joint file: kn, kt at each force",
        parameters="parameters of the contact (CSV)",
        settings="laser_x_mm by mode, sections `nonlinear`, `diagnosis` of config.yaml (JSON)",
        model="optional: model file (YAML) whose amplitude causes take the friction's place",
        output="nonlinear file",
    )
