"""Why the verdict on a campaign's simulation is what it is, in text."""

from collections.abc import Sequence

import click

from bladeroot.artifacts import load, load_json
from bladeroot.command.results import results_of


@click.command()
@click.argument("campaign")
def command(campaign: str) -> None:
    """Say in text why the verdict on CAMPAIGN's simulation is what it is."""
    from bladeroot.report.verdict import answer_of, compared_with, sentences_of, with_open

    folder = results_of(campaign) / "diagnosis"
    main = folder / "verdict.json"
    if not main.is_file():
        raise ValueError(f"the campaign has no verdict ({main})")
    said = load_json(main)  # a copy of that on one of the structures
    same = [p for p in sorted(folder.glob("*.json")) if p != main and load_json(p) == said]
    if not same:
        raise ValueError(f"the verdict is of none of the diagnoses beside it; run again ({main})")
    one = load(same[0].with_suffix(".nc"))
    simulated, shown = bool(one.attrs["simulated"]), with_open(said)
    lines = sentences_of(one, shown, simulated).box.lines
    head = f"{said['campaign']}, compared with {compared_with(one, shown)}: {answer_of(shown)}"
    click.echo("Simulated campaign. " * simulated + head)
    click.echo("\n".join([*lines, *_beside(said["reason"], lines)]))


def _beside(reason: str, lines: Sequence[str]) -> list[str]:
    """What the long reason says and the lines do not.

    Its sentences begin in lower case, and have causes by their ids and what to measure next.
    """
    told = _plain("\n".join(lines))
    more = [
        one
        for one in reason.split(". ")
        if _plain(one).partition("; to decide:")[0].rstrip(".") not in told
    ]
    return (
        ["Besides: " + ". ".join(one[0].upper() + one[1:] for one in more if one)] if more else []
    )


def _plain(text: str) -> str:
    return text.lower().replace("-", " ")
