"""The whole workflow on one campaign, with progress by stage."""

import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import click

from bladeroot.runs import system_fault

CHECKOUT = Path(__file__).resolve().parents[3]
_DONE = re.compile(r"^(\d+) of (\d+) steps")
_STAGE = re.compile(r"^(?:Job \d+|localrule|rule): (.+)")


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("campaign", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("-j", "--jobs", type=int, default=2, show_default=True, help="Jobs at a time.")
@click.argument("options", nargs=-1, type=click.UNPROCESSED)
def command(campaign: Path, jobs: int, options: tuple[str, ...]) -> None:
    """Run the workflow on CAMPAIGN; results go to results/ here. OPTIONS are Snakemake's.

    The same command after new records, a changed setting or an interruption does what is left.
    """
    snakefile = CHECKOUT / "Snakefile"
    if not snakefile.is_file():
        raise ValueError(f"the workflow is not part of the library; expected a clone's {snakefile}")
    asked = [
        sys.executable, "-m", "snakemake", f"-j{jobs}", "--snakefile", str(snakefile),
        "--workflow-profile", str(CHECKOUT / "profiles" / "default"), *options,
        "--config", f"campaigns={campaign.resolve()}",
    ]  # fmt: skip
    run = subprocess.Popen(asked, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for line in followed(
        run.stdout, lambda text: click.echo(f"\r\033[K{text}", nl=False, err=True)
    ):
        click.echo(line)
    sys.exit(run.wait())


def followed(lines: Iterable[str], show) -> list[str]:
    """Show how far a run is and what it does, as it prints; what stands behind its last step.

    lines: of Snakemake's own output. show: takes one short line of progress.
    """
    rest, share = [], ""
    for line in lines:
        text = line.rstrip()
        done, stage = _DONE.match(text), _STAGE.match(text)
        if done:
            share, rest = f"{done[1]} of {done[2]}", []
        elif stage:
            show(f"{share:>10}  {stage[1]}"[:78])
        rest.append(text)
    show("")
    fault = system_fault("\n".join(rest))
    if fault:
        return [f"bladeroot: {fault}; the same command continues when that is put right"]
    return [text for text in rest if text and not _DONE.match(text)]
