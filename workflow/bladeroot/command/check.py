"""Whether a campaign's files are right, before any work."""

from pathlib import Path

import click

from bladeroot.io.campaign import load_campaign


@click.command()
@click.argument("campaign", type=click.Path(exists=True, file_okay=False, path_type=Path))
def command(campaign: Path) -> None:
    """Check campaign.yaml, the sheet and the files that they name, a line a fault."""
    made = load_campaign(campaign)
    for line in made.warnings:
        click.echo(f"warning: {line}", err=True)
    modes = ", ".join(made.description["modes"])
    rows = (
        f"{len(made.records)} records" if made.records else f"{len(made.stick)} stick frequencies"
    )
    left = f", {len(made.excluded)} excluded" if made.excluded else ""
    click.echo(f"{made.name}: {rows}{left}, modes {modes}: nothing wrong")
