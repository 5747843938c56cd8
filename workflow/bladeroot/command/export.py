"""Results for other programs."""

from pathlib import Path

import click

from bladeroot.command.results import results_of


@click.command()
@click.argument("campaign")
@click.option(
    "--to",
    "folder",
    type=click.Path(file_okay=False, path_type=Path),
    help="By default results/CAMPAIGN/export.",
)
def command(campaign: str, folder: Path | None) -> None:
    """Write curves, stick frequencies and verdict of CAMPAIGN as CSV, MATLAB and universal file."""
    from bladeroot.public.export import export

    results = results_of(campaign)
    for path in export(results, folder or results / "export"):
        click.echo(path)
