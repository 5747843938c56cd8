"""The whole workflow on one campaign, with progress by stage."""

import argparse
import re
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

import click

from bladeroot.command.check import tell_warnings
from bladeroot.command.results import refuse_another
from bladeroot.io.campaign import load_campaign
from bladeroot.runs import system_fault

CHECKOUT = Path(__file__).resolve().parents[3]
_DONE = re.compile(r"^(\d+) of (\d+) steps")
_STAGE = re.compile(r"^(?:Job \d+|localrule|rule): (.+)")
_COUNT = re.compile(r"^(\S+) {2,}(\d+)$")
_ENDED = re.compile(r"^Finished jobid: \d+ \(Rule: (\S+)\)")
# By rule, how long a job lasts over a short one: measured (results/timings.csv).
_DURATIONS = {
    "accuracy": 6, "amplitude": 8, "assembly_reduced": 7, "bench": 10, "calibrate": 60, "checks": 7,
    "diagnosis": 3, "frequency_maps": 3, "joint": 4, "matrices_reduced": 7, "nonlinear": 4,
    "parametric": 6, "reduced": 7, "ringdown": 10, "shortfall": 2, "slider": 2,
}  # fmt: skip


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
    refuse_another(campaign)
    tell_warnings(load_campaign(campaign))
    settings, others = settings_among(options)
    asked = [
        sys.executable, "-m", "snakemake", f"-j{jobs}", "--snakefile", str(snakefile),
        "--workflow-profile", str(CHECKOUT / "profiles" / "default"), *others,
        "--config", *settings, f"campaigns={campaign.resolve()}",
    ]  # fmt: skip
    run = subprocess.Popen(asked, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    over = sys.stderr.isatty()  # in a log each step is a line

    def show(text: str) -> None:
        if over or text:
            click.echo(f"\r\033[K{text}" if over else text, nl=not over, err=True)

    for line in followed(run.stdout, show):
        click.echo(line)
    sys.exit(run.wait())


def settings_among(options: Iterable[str]) -> tuple[list[str], list[str]]:
    """What --config sets, and the other options: of several --config Snakemake takes the last."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-C", "--config", nargs="*", action="extend", default=[])
    said, others = parser.parse_known_args(list(options))
    return said.config, others


def followed(lines: Iterable[str], show, clock=time.monotonic) -> list[str]:
    """Show how far a run is, what it does and how long it may take, as it prints; what stands
    behind its last step.

    lines: of Snakemake's own output. show: takes one short line of progress. clock: time in s; what
    is left is taken to last as what is done did, a long rule's job counting as many short ones.
    """
    rest, share, start = [], "", clock()
    whole = past = 0
    for line in lines:
        text = line.rstrip()
        done, stage = _DONE.match(text), _STAGE.match(text)
        if count := _COUNT.match(text):
            whole += int(count[2]) * _long(count[1]) * (count[1] != "total")
        if over := _ENDED.match(text):
            past += _long(over[1])
        if done:
            ended, every = int(done[1]), int(done[2])
            left = (clock() - start) * max(whole - past, 0) / max(past, 1)
            share, rest = f"{ended} of {every}, about {left / 60.0:.0f} min left", []
            if left < 60.0:
                share = f"{ended} of {every}, about {left:.0f} s left"
        elif stage:
            show(f"{share:>28}  {stage[1]}"[:78])
        rest.append(text)
    show("")
    fault = system_fault("\n".join(rest))
    if fault:
        return [f"bladeroot: {fault}; the same command continues when that is put right"]
    return [text for text in rest if text and not _DONE.match(text)]


def _long(rule: str) -> int:
    return _DURATIONS.get(rule.partition(".")[0], 1)
