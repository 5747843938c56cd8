"""The report of a campaign, one self-contained page -> report.html."""

import json
from pathlib import Path

import pandas as pd
import yaml
from _cli import run
from bladeroot import __version__, artifacts
from bladeroot.report.errata import errata_section
from bladeroot.report.measurement import measurement_section, stick_section, table_5_1
from bladeroot.report.page import Section, render
from bladeroot.report.stiffness import stiffness_section
from bladeroot.report.structure import structure_section
from bladeroot.report.summary import summary_section, undecided_section
from bladeroot.report.theory import theory_section


def main(results, checks, figures, thesis, facts, output):
    known = json.loads(facts)
    folder = Path(results)
    stage = {
        name: artifacts.load(folder / f"{name}.nc")
        for name in ("stick", "fe_forces", "stiffness", "theory")
    }
    score = artifacts.load(folder / "score.nc") if known["simulated"] else None
    drawn = {Path(figure).stem: _inline(Path(figure).read_text()) for figure in figures}
    held = [artifacts.load(check) for check in checks]
    published, errata = thesis
    sticks = stick_section(stage["stick"], drawn["stick"], score, stage["fe_forces"])
    if not known["simulated"]:
        comparison = table_5_1(stage["fe_forces"], pd.read_csv(published))
        sticks = Section(sticks.title, [*sticks.parts, *comparison])
    sections = [
        summary_section(stage["stick"], stage["stiffness"], stage["theory"]),
        measurement_section(known, stage["stick"], drawn),
        sticks,
        structure_section({check.attrs["structure"]: check for check in held}, drawn["structure"]),
        stiffness_section(stage["stiffness"], drawn["maps"], score),
        theory_section(stage["theory"], stage["stiffness"], drawn["tractions"], drawn["compared"]),
        undecided_section(known, stage["stick"], stage["stiffness"]),
        errata_section(yaml.safe_load(Path(errata).read_text())),
    ]
    page = render(
        known["description"]["title"],
        f"Campaign {known['campaign']}: from ring-downs to contact stiffness",
        known["simulated"],
        sections,
        f"bladeroot {__version__}",
    )
    artifacts.save_text(page, output)


def _inline(svg):
    """The drawing without the file's XML head, to stand inside a page."""
    return svg[svg.index("<svg") :]


if __name__ == "__main__":
    run(
        main,
        results="the campaign's folder of artifacts",
        checks="many: checks.nc of its structures",
        figures="many: figures (SVG)",
        thesis="many: table_5_1.csv and errata.yaml",
        facts="what is known of the campaign (JSON)",
        output="report.html",
    )
