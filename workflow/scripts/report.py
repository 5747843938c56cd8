"""The report of a campaign: report.html, and its chapters and the plotting library in report/."""

import datetime
import hashlib
import json
import shutil
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import yaml
from _cli import run
from bladeroot import __version__, artifacts
from bladeroot.figures.records import worth_showing
from bladeroot.files import save_text, whole_file
from bladeroot.io.campaign import load_campaign
from bladeroot.provenance import environment
from bladeroot.report.contents import LIBRARY, Material, report
from bladeroot.reproduction.published import published_stiffness


def main(
    results,
    structures,
    batches,
    modes,
    calibrations,
    sources,
    tables,
    errata,
    folder,
    facts,
    threads="1",
):
    known, home = json.loads(facts), Path(results)
    library = _library()
    of_the_thesis = known["description"].get("published") == "thesis"
    names = ["stick"] + ["fe_forces", "stiffness", "theory"] * bool(known["structures"])
    names += ["score"] * known["simulated"] + ["integrity", "curves"] * bool(batches)
    names += ["ledger", "slider"] * of_the_thesis
    stages = {name: artifacts.load(home / f"{name}.nc") for name in names}

    def by_structure(pattern, asked=known["structures"]):
        return [artifacts.load(pattern.format(name)) for name in asked]

    made = {
        "version": __version__,
        "date": datetime.date.today().isoformat(),
        "environment": environment(),
        "command": known["command"],
        "settings": known["settings"],
        "sources": _hashes([*map(Path, sources), *_raw(folder, known)], Path(folder)),
    }
    pages = report(
        Material(
            known,
            stages,
            by_structure(f"{results}/diagnosis/{{}}.nc", known["judged"]),
            [artifacts.load_json(home / "diagnosis" / f"{one}.json") for one in known["judged"]],
            made,
            of_records=partial(_of_records, batches, home) if batches else None,
            mesh=next(
                iter(by_structure(f"{structures}/{{}}/mesh.nc", known["structures"][:1])), None
            ),
            modes="".join(_inline(Path(path)) for path in modes),
            checks=by_structure(f"{structures}/{{}}/checks.nc"),
            accuracies=by_structure(f"{structures}/{{}}/accuracy.nc"),
            calibrations=[artifacts.load(path) for path in calibrations],
            searches=[
                artifacts.load(home / "stiffness" / name / f"{force}.nc")
                for name in known["structures"]
                for force in known["forces"]
            ],
            joints=by_structure(f"{results}/joint/{{}}.nc"),
            extended=by_structure(f"{results}/extended/{{}}/joint.nc", known["extended"]),
            amplitudes=by_structure(f"{results}/amplitude/{{}}.nc") if batches else [],
            shortfalls=by_structure(f"{structures}/{{}}/shortfall.nc"),
            thesis_searches=by_structure(f"{results}/thesis_search/{{}}.nc")
            if of_the_thesis
            else [],
            published=_published(*tables) if tables else None,
            errata=[
                one for path in errata for one in yaml.safe_load(Path(path).read_text("utf-8"))
            ],
        ),
        int(threads),
    )
    chapters = home / "report"
    for place, page in pages.items():
        save_text(page, home / place)
    artifacts.save_json(made, chapters / "provenance.json")
    with whole_file(chapters / LIBRARY) as part:
        shutil.copyfile(library, part)


def _published(forces, stiffness):
    """Tables 5.1 and 5.2 as printed."""
    return pd.read_csv(forces), published_stiffness(pd.read_csv(stiffness).to_dict("list"))


def _of_records(batches, folder):
    """The decays, and the raw records that are worth showing with their spectra."""
    from bladeroot.decay.spectra import FADE_CYCLES, before_and_after  # late: of records alone

    decays = artifacts.load_records(batches, "decay", without=("pff_*",))
    found = {decay.attrs["record"]: decay for decay in decays}
    told = worth_showing(
        artifacts.load_records(
            batches, "records", without=("velocity", "time", "overview_m*", "widening*")
        ),
        found,
    )
    shown = [
        artifacts.load(folder / "records" / f"{one.attrs['record']}.nc").assign_attrs(one.attrs)
        for one in told
    ]
    spectra = [
        before_and_after(
            one["velocity"].values.astype(float),
            one.attrs["sampling_Hz"],
            found[one.attrs["record"]],
            one["usable"].values.astype(bool),
        ).assign_attrs(reason=one.attrs["reason"])
        for one in shown
        # a few cycles have no spectrum to speak of
        if one.sizes["time"] * one.attrs["expected_Hz"] > 2 * FADE_CYCLES * one.attrs["sampling_Hz"]
    ]
    return {"decays": decays, "shown": shown, "spectra": spectra}


def _raw(folder, known):
    """The measured files."""
    if known["simulated"] or known["entry"] != "records":
        return []
    return [Path(folder) / row["file"] for row in load_campaign(folder).records]


def _hashes(paths, folder):
    """sha256 by path, below the campaign's folder where it is there."""
    found = {}
    for path in dict.fromkeys(paths):
        with open(path, "rb") as source:
            name = path.relative_to(folder) if path.is_relative_to(folder) else path.name
            found[str(name)] = hashlib.file_digest(source, "sha256").hexdigest()
    return found


def _library():
    """The plotting library for the pages, as its package for Python brings it."""
    package = find_spec("plotly")
    if package is None:
        raise ValueError("plotly is not installed; pip install -r environment.txt installs it")
    return Path(package.origin).parent / "package_data" / LIBRARY


def _inline(path):
    """A drawing without the file's XML head, to stand inside a page."""
    text = path.read_text(encoding="utf-8")
    return text[text.index("<svg") :]


if __name__ == "__main__":
    run(
        main,
        results="the campaign's folder of artifacts",
        structures="the folder of the structures' artifacts",
        batches="any: lists of the records in each batch",
        modes="any: mode shapes of the main structure (SVG)",
        calibrations="any: calibration.nc of its structures",
        sources="any: files that the campaign was made of",
        tables="any: Tables 5.1 and 5.2 as printed (CSV), of a campaign that states them",
        errata="any: the errata of these",
        folder="the campaign's own folder",
        facts="what is known of the campaign (JSON)",
        threads="optional: processes that draw side by side",
    )
