"""The folder of a campaign: records, sheet, and what an analyst knows of the specimen."""

import csv
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.io import mmwrite, wavfile

from stranger_lab.bench import Bench
from stranger_lab.signal import velocity

STRUCTURE = """\
name: clamp-beam
kind: assembly
description: Beam held between two jaws, own brick model.
units: m-N-kg
bodies:
  beam: {{nodes: fe/beam.csv, mass: fe/beam_M.mtx, stiffness: fe/beam_K.mtx{geometric}}}
  jaws: {{nodes: fe/jaws.csv, fixed: fe/held.csv, mass: fe/jaws_M.mtx, stiffness: fe/jaws_K.mtx}}
contact: fe/contact.csv
interfaces:
  clamp: {{kn_N_per_m: [1.0e+8, 1.0e+10], kt_N_per_m: [1.0e+8, 1.0e+10]}}
display_nodes: {{beam: [{display}]}}
modes:
{modes}
reduction: {{modes: 30}}
"""
CAMPAIGN = """\
title: campaign {seed}
modes:
{modes}
load: {{name: {load}, unit: kN, gauge: load cell, full_scale: 25, accuracy_percent: 1, \
accuracy_of: reading}}
simulation: {simulation}
"""
SIMULATION = {"assembly": "clamp-beam", "table": "mine.csv", "none": "none"}


def write_campaign(bench: Bench, folder: Path) -> None:
    """All files but the truth."""
    (folder / "raw").mkdir(parents=True)
    rows = [_record(bench, number, folder) for number in range(len(bench.visits))]
    _table(folder / "records.csv", list(rows[0]), [list(row.values()) for row in rows])
    modes = [
        f"  {mode}: {{expected_Hz: {hertz:.4g}}}"
        for mode, hertz in zip(bench.modes, bench.expected_Hz, strict=True)
    ]
    (folder / "campaign.yaml").write_text(
        CAMPAIGN.format(
            seed=bench.seed,
            modes="\n".join(modes),
            load="tension" if bench.tension else "clamping force",
            simulation=SIMULATION[bench.model],
        )
    )
    if bench.model == "assembly":
        _assembly(bench, folder)
    elif bench.model == "table":
        _frequencies(bench, folder / "mine.csv")


def _table(path: Path, head: list[str], rows: list) -> None:
    with path.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


def _record(bench: Bench, number: int, folder: Path) -> dict:
    """Write 16 bits; the row of the sheet."""
    visit, name = bench.visits[number], f"r{number + 1:03d}"
    digits = np.round(velocity(bench, number) / bench.full_scale * 32767)
    samples = np.clip(digits, -32768, 32767).astype(np.int16)
    wavfile.write(folder / "raw" / f"{name}.wav", bench.sampling_Hz, samples)
    row = {
        "record": name,
        "file": f"raw/{name}.wav",
        "mode": " ".join(bench.modes[j] for j in visit.modes),
        "load": bench.loads[visit.load],
        "clamping": f"c{visit.clamping}",
        "direction": visit.direction,
        "time_s": round(visit.time_s, 1),
        "quantity": "velocity",
        "sensitivity": f"{bench.full_scale * 1e3:.6g} mm/s/FS",
    }
    if "temperature" in bench.effects:
        row["temperature_C"] = round(bench.temperature[number], 2)
    if bench.with_group:
        row["group"] = f"operator {visit.operator}"
    return row


def _assembly(bench: Bench, folder: Path) -> None:
    """Matrices, nodes, contact pairs and mode shapes of both bodies."""
    beam, fe = bench.beam, folder / "fe"
    fe.mkdir()
    matrices = {
        "beam_K": beam.stiffness, "beam_M": beam.mass, "jaws_K": beam.jaw_stiffness,
        "jaws_M": beam.jaw_mass,
    } | ({"beam_G": beam.geometric} if bench.tension else {})  # fmt: skip
    for name, matrix in matrices.items():
        even = sp.coo_matrix((matrix + matrix.T) / 2)
        mmwrite(fe / f"{name}.mtx", even, symmetry="symmetric", precision=16)
    for name, nodes in (("beam", beam.nodes), ("jaws", beam.jaw_nodes)):
        rows = [[i + 1, *(f"{x:.9g}" for x in place)] for i, place in enumerate(nodes)]
        _table(fe / f"{name}.csv", ["node", "x", "y", "z"], rows)
    _table(fe / "held.csv", ["node"], [[i + 1] for i in beam.held])
    ends = ["first_body", "first_node", "second_body", "second_node"]
    head = ["interface", *ends, "area", "nx", "ny", "nz"]
    pairs = [
        ["clamp", "beam", first + 1, "jaws", second + 1, f"{area:.6g}", 0, 0, side]
        for first, second, area, side in beam.pairs
    ]
    _table(fe / "contact.csv", head, pairs)
    x, y, z = beam.nodes.T
    shown = np.flatnonzero((x >= 0) & (z > 0) & (np.abs(y) > 1e-6))
    for mode in bench.modes:
        u = beam.displacements(beam.shapes[mode])
        u = u / np.abs(u[shown]).max()
        rows = [["beam", i + 1, *(f"{part:.6f}" for part in u[i])] for i in shown]
        _table(fe / f"{mode}.csv", ["body", "node", "x", "y", "z"], rows)
    (folder / "clamp-beam.yaml").write_text(
        STRUCTURE.format(
            geometric=", geometric_stiffness: fe/beam_G.mtx" if bench.tension else "",
            display=", ".join(str(i + 1) for i in shown),
            modes="\n".join(f"  {mode}: {{shape: fe/{mode}.csv}}" for mode in bench.modes),
        )
    )


def _frequencies(bench: Bench, path: Path) -> None:
    """A table of simulated frequencies over load: 16 loads in half of the campaigns, else 150."""
    rng, loads, rows = bench.rng, bench.loads, []
    kn, kt = (k * np.exp(rng.normal(0, 0.05)) for k in (bench.kn, bench.kt))
    first, last = loads[0], loads[-1]
    if rng.integers(2):
        told = np.r_[0.8 * first, np.linspace(first, last, 14), 1.2 * last]
    else:
        told = np.r_[np.geomspace(0.8 * first, min(1.15 * last, 25.0), 150), loads]
    for load in np.unique(told):
        k = (kn * bench.simulated(1e3 * load), kt * bench.simulated(1e3 * load))
        known = (bench.modes, *k, 1e3 * load * bench.tension)
        plain = bench.beam.frequencies(*known)
        slopes = bench.beam.slopes(*known, step=0.01)
        stiffer = np.log(bench.beam.frequencies(*known, 1.01) / plain) / np.log(1.01)
        for mode, hertz, *rest in zip(bench.modes, plain, *slopes, stiffer, strict=True):
            rows.append([mode, f"{load:.4f}", f"{hertz:.5f}", *(f"{one:.6f}" for one in rest)])
    head = ["mode", "load", "frequency_Hz", "by_ln_kn", "by_ln_kt", "by_modulus"]
    _table(path, head, rows)
