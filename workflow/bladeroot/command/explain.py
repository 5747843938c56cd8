"""Why the verdict on a campaign's simulation is what it is, in text."""

from collections.abc import Iterator

import click

from bladeroot.artifacts import load_json
from bladeroot.command.results import results_of

ANSWERS = {
    "nothing-missing": "The simulation explains the records within their scatter.",
    "named": "The records name what the simulation misses.",
    "ambiguous": "The records do not tell which of several causes is missing, or whether one is.",
    "unexplained": "The simulation misses something that no cause of the catalogue explains.",
    "insufficient-data": "The records are too few to judge the simulation.",
}


@click.command()
@click.argument("campaign")
def command(campaign: str) -> None:
    """Say in text why the verdict on CAMPAIGN's simulation is what it is."""
    path = results_of(campaign) / "diagnosis" / "verdict.json"
    if not path.is_file():
        raise ValueError(f"the campaign has no verdict ({path})")
    for line in explained(load_json(path)):
        click.echo(line)


def explained(verdict: dict) -> Iterator[str]:
    """The verdict's fields as lines."""
    yield f"{verdict['campaign']}: {verdict['answer']}. {ANSWERS[verdict['answer']]}"
    if verdict.get("structure"):
        yield f"Judged against {verdict['structure']}."
    for cause in verdict["causes"]:
        if verdict["answer"] == "nothing-missing":
            names = [name for name in cause["credible_set"] if name != "none"]
            yield f"  would show neither way: {', '.join(names)}"
            continue
        doubt = "" if cause.get("plausible", True) else ", with values that are not plausible"
        yield f"  {cause['mechanism']} ({cause['class']}){doubt}"
        for value in cause["parameters"]:
            unit = "" if value["unit"] == "1" else f" {value['unit']}"
            yield f"    {value['name']} {value['value']:.3g} +- {value['std']:.2g}{unit}"
        rivals = [name for name in cause["credible_set"] if name != cause["mechanism"]]
        if rivals:
            yield f"    as credible: {', '.join(rivals)}"
        if cause.get("splitter"):
            yield f"    what tells it from others: {cause['splitter']}"
    chances = verdict.get("probabilities") or {}
    for name, chance in sorted(chances.items(), key=lambda item: -item[1]):
        if chance >= 0.005:
            yield f"  {chance:6.1%}  {name}"
    if verdict.get("reason"):
        yield str(verdict["reason"])
