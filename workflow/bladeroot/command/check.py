"""Whether a campaign's files are right, before any work, and whether a result is current."""

import os
import sys
from pathlib import Path

import click

from bladeroot.io.campaign import Campaign, load_campaign


@click.command()
@click.argument("campaign", type=click.Path(path_type=Path))
def command(campaign: Path) -> None:
    """Check campaign.yaml, the sheet, a structure's matrices and the raw files, which are all read,
    a line a fault.

    Of a file in results/ (or a campaign's folder there, which stands for its report) say whether it
    is what its inputs, settings and code would make now, and why not.
    """
    if "results" in campaign.parts and not (campaign / "campaign.yaml").exists():
        _tell_currency(campaign / "report.html" if campaign.is_dir() else campaign)
        return
    made = load_campaign(campaign)
    faults = []
    if made.description["structure"]:
        from bladeroot.public.diagnosis import faults_of_matrices  # late: arrays

        faults += faults_of_matrices(made)
    tell_warnings(made)
    if made.records and not made.simulated:
        from bladeroot.public.decay import faults_of_files  # late: arrays

        faults += faults_of_files(made)
    if faults:
        raise ValueError("\n".join(faults))
    modes = ", ".join(made.description["modes"])
    rows = (
        f"{len(made.records)} records" if made.records else f"{len(made.stick)} stick frequencies"
    )
    left = f", {len(made.excluded)} excluded" if made.excluded else ""
    click.echo(f"{made.name}: {rows}{left}, modes {modes}: nothing wrong")


def tell_warnings(made: Campaign) -> None:
    """What is suspicious in a campaign's files and no fault, a line each."""
    for line in made.warnings:
        click.echo(f"warning: {line}", err=True)


def _tell_currency(result: Path) -> None:
    from bladeroot.command.currency import why_not_current

    if not os.path.lexists(result):
        raise ValueError(f"{result} is not there; `snakemake -j2 {result}` makes it")
    reasons = why_not_current(os.path.relpath(result))
    if not reasons:
        click.echo(f"{result}: current")
        return
    for line in reasons:
        click.echo(f"{result}: not current: {line}")
    sys.exit(1)
