"""Beam and slots joined, and the joint's frequencies over kn and kt, at each axial force."""

from pathlib import Path

from _cli import run
from bladeroot import artifacts
from bladeroot.rom.assembly import assemble
from bladeroot.stiffness.map import frequency_map


def main(reduced, parametric, assemblies, maps):
    beam_and_slots, model = artifacts.load(reduced), artifacts.load(parametric)
    for joined, drawn in zip(assemblies, maps, strict=True):
        assembly = assemble(beam_and_slots, float(Path(joined).stem))
        artifacts.save(assembly, joined)
        artifacts.save(frequency_map(model, assembly), drawn)


if __name__ == "__main__":
    run(
        main,
        reduced="reduced.nc",
        parametric="parametric.nc",
        assemblies="many: assembly/<force in N>.nc to write",
        maps="many: map/<force in N>.nc to write, in the same order",
    )
