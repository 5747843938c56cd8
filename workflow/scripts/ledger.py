"""Every number that the thesis prints beside what is computed -> ledger.nc."""

from pathlib import Path

import pandas as pd
import yaml
from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.build import ledger
from bladeroot.reproduction.entry import Evidence


def main(stages, checks, reduced, maps, thesis, parameters, output):
    folder = Path(thesis)
    loaded = {Path(path).stem: artifacts.load(path) for path in stages}
    tables = {
        path.stem.removeprefix("table_"): pd.read_csv(path)
        for path in sorted(folder.glob("table_*.csv"))
    }
    evidence = Evidence(
        loaded,
        _by_structure(checks),
        _by_structure(reduced),
        _maps(maps),
        tables,
        pd.read_csv(parameters, index_col="name")["value"].to_dict(),
    )
    listed = [
        yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
        for name in ("ledger", "errata", "contents")
    ]
    artifacts.save(ledger(*listed, evidence), output, origin=loaded["stiffness"])


def _by_structure(paths):
    parts = [artifacts.load(path) for path in paths]
    return {part.attrs["structure"]: part for part in parts}


def _maps(paths):
    """By structure and axial force."""
    out = {}
    for part in map(artifacts.load, paths):
        out.setdefault(part.attrs["structure"], {})[float(part.attrs["axial_force"])] = part
    return out


if __name__ == "__main__":
    run(
        main,
        stages="many: stick.nc, fe_forces.nc, stiffness.nc, theory.nc, slider.nc",
        checks="many: checks.nc of the structures",
        reduced="many: reduced.nc of the structures",
        maps="many: frequency maps of the structures",
        thesis="folder with ledger.yaml, errata.yaml, contents.yaml and the printed tables",
        parameters="parameters of the contact (CSV)",
        output="ledger.nc",
    )
