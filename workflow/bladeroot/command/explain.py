"""Why the verdict on a campaign's simulation is what it is, in text."""

import click

from bladeroot.artifacts import load, load_json
from bladeroot.command.results import results_of


@click.command()
@click.argument("campaign")
def command(campaign: str) -> None:
    """Say in text why the verdict on CAMPAIGN's simulation is what it is."""
    from bladeroot.report.verdict import sentences_of, with_open

    folder = results_of(campaign) / "diagnosis"
    main = folder / "verdict.json"
    if not main.is_file():
        raise ValueError(f"the campaign has no verdict ({main})")
    said = load_json(main)  # a copy of that on one of the structures
    same = [p for p in sorted(folder.glob("*.json")) if p != main and load_json(p) == said]
    if not same:
        raise ValueError(f"the verdict is of none of the diagnoses beside it; run again ({main})")
    one = load(same[0].with_suffix(".nc"))
    box = sentences_of(one, with_open(said), bool(one.attrs["simulated"])).box
    click.echo("\n".join([box.head, *box.lines, f"In full: {said['reason']}"]))
