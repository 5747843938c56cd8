"""The report of a campaign, one self-contained page -> report.html."""

import json
from pathlib import Path

import pandas as pd
import yaml
from _cli import run
from bladeroot import __version__, artifacts
from bladeroot.report.contents import report


def main(
    results, checks, accuracies, calibrations, joints, diagnoses, verdicts, extended, amplitudes,
    shortfalls, figures, thesis, facts, output,
):  # fmt: skip
    known = json.loads(facts)
    structures = known["structures"]
    names = ["stick"] + ["fe_forces", "stiffness", "theory"] * bool(structures)
    names += ["score"] * known["simulated"]
    names += ["integrity", "curves"] * (known["entry"] == "records")
    names += ["ledger"] * (known["description"].get("published") == "thesis")
    published, errata = thesis
    searched = [
        Path(results) / "thesis_search" / f"{structure}.nc"
        for structure in structures
        if known["description"].get("published") == "thesis"
    ]
    page = report(
        known,
        {name: artifacts.load(Path(results) / f"{name}.nc") for name in names},
        [artifacts.load(check) for check in checks],
        [artifacts.load(accuracy) for accuracy in accuracies],
        [artifacts.load(calibration) for calibration in calibrations],
        [artifacts.load(joint) for joint in joints],
        [artifacts.load(diagnosis) for diagnosis in diagnoses],
        [artifacts.load_json(verdict) for verdict in verdicts],
        [artifacts.load(joint) for joint in extended],
        [artifacts.load(amplitude) for amplitude in amplitudes],
        [artifacts.load(shortfall) for shortfall in shortfalls],
        [artifacts.load(search) for search in searched],
        {
            Path(figure).stem: _inline(Path(figure).read_text(encoding="utf-8"))
            for figure in figures
        },
        pd.read_csv(published),
        yaml.safe_load(Path(errata).read_text(encoding="utf-8")),
        __version__,
    )
    artifacts.save_text(page, output)


def _inline(svg):
    """The drawing without the file's XML head, to stand inside a page."""
    return svg[svg.index("<svg") :]


if __name__ == "__main__":
    run(
        main,
        results="the campaign's folder of artifacts",
        checks="any: checks.nc of its structures",
        accuracies="any: accuracy.nc of its structures",
        calibrations="any: calibration.nc of its structures",
        joints="any: joint inferences of its structures",
        diagnoses="any: diagnosis with each of its structures, the main one first",
        verdicts="any: verdicts of the same structures (JSON)",
        extended="any: joint inferences with the causes of a model file",
        amplitudes="any: inferences with amplitude of its structures",
        shortfalls="any: shortfall.nc of its structures",
        figures="many: figures (SVG)",
        thesis="many: table_5_1.csv and errata.yaml",
        facts="what is known of the campaign (JSON)",
        output="report.html",
    )
