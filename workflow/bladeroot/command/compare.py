"""Two campaigns, or two runs of one, side by side."""

from pathlib import Path

import click

from bladeroot import artifacts
from bladeroot.command.results import results_of
from bladeroot.files import save_text


@click.command()
@click.argument("one")
@click.argument("other")
@click.option(
    "--to",
    "place",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The page; by default results/ONE-OTHER.html.",
)
def command(one: str, other: str, place: Path | None) -> None:
    """Say what differs between ONE and OTHER: verdict, numbers, records, settings.

    Each is a campaign with results here, or a folder of a campaign's results elsewhere (a copy made
    before a setting was changed).
    """
    from bladeroot.report.compare import compared, page, text

    folders = [_folder(name) for name in (one, other)]
    names = [folder.name for folder in folders]
    labels = names if names[0] != names[1] else [str(Path(name)) for name in (one, other)]
    sides = [_side(folder, label) for folder, label in zip(folders, labels, strict=True)]
    for line in text(compared(*sides)):
        click.echo(line)
    place = place or Path("results") / f"{'-'.join(names)}.html"
    save_text(page(*sides), place)
    click.echo(f"page: {place}")


def _folder(name: str) -> Path:
    """A folder of results of that path, else those of a campaign of that name here."""
    return Path(name) if (Path(name) / "stick.nc").is_file() else results_of(name)


def _side(folder: Path, label: str):
    from bladeroot.report.compare import Side

    joints = [artifacts.load(path) for path in sorted((folder / "joint").glob("*.nc"))]
    return Side(
        label,
        artifacts.load_json(folder / "report" / "provenance.json"),
        artifacts.load(folder / "stick.nc"),
        artifacts.load_json(folder / "diagnosis" / "verdict.json"),
        {one.attrs["structure"]: one for one in joints if one.attrs["law"]},
        artifacts.load(folder / "curves.nc") if (folder / "curves.nc").is_file() else None,
    )
