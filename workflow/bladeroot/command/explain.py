"""Why the verdict on a campaign's simulation is what it is, in text."""

from collections.abc import Iterator, Mapping

import click

from bladeroot.artifacts import load, load_json
from bladeroot.command.results import results_of


@click.command()
@click.argument("campaign")
def command(campaign: str) -> None:
    """Say in text why the verdict on CAMPAIGN's simulation is what it is."""
    folder = results_of(campaign) / "diagnosis"
    main = folder / "verdict.json"
    if not main.is_file():
        raise ValueError(f"the campaign has no verdict ({main})")
    said = load_json(main)  # a copy of that on one of the structures
    one = next(p for p in folder.glob("*.json") if p != main and load_json(p) == said)
    for line in explained(load(one.with_suffix(".nc")), said):
        click.echo(line)


def explained(one, said: Mapping) -> Iterator[str]:
    """The verdict as lines; one: the diagnosis's artifact."""
    from bladeroot.report.verdict import told, with_open

    box = told(one, with_open(said), bool(one.attrs["simulated"])).box
    yield box.head
    yield from box.lines
    yield f"In full: {said['reason']}"
