"""Where a campaign's results are, and whether they are those of its files."""

import os
from pathlib import Path

import click

from bladeroot.artifacts import load_json


def results_of(campaign: str) -> Path:
    """Its folder below results/, from the campaign's name or folder. ValueError without one.

    Says so if they are not what its files would make now.
    """
    folder = Path("results") / Path(campaign).name
    if not folder.is_dir():
        raise ValueError(f"no results here; bladeroot run {campaign} makes them ({folder})")
    _warn_if_outdated(folder)
    return folder


def _warn_if_outdated(results: Path) -> None:
    from bladeroot.command.currency import why_not_current  # late: Snakemake plans

    report = results / "report.html"
    if not report.exists():
        return
    try:
        why = why_not_current(os.path.relpath(report))
    except ValueError:  # nothing states how they were made
        return
    for line in why:
        click.echo(f"warning: {results} is not current: {line}", err=True)


def refuse_another(campaign: Path) -> None:
    """ValueError where the results of that name are another folder's that is still there."""
    made = Path("results") / campaign.resolve().name / "report" / "provenance.json"
    try:
        before = Path(load_json(made)["command"].removeprefix("bladeroot run "))
    except ValueError:  # there are none, or a damaged file, which is made again
        return
    if (before / "campaign.yaml").is_file() and not before.samefile(campaign):
        raise ValueError(
            f"{made.parents[1]} are the results of {before}: expected a folder of another name, or "
            f"another working directory ({campaign})"
        )
