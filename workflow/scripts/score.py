"""Stick frequencies of simulated records beside the bench's truth -> score.nc."""

from pathlib import Path

from _cli import run
from bladeroot import artifacts
from bladeroot.report.score import score


def main(stick, truths, output):
    found = artifacts.load(stick)
    records = found["record"].values.astype(str)
    answers = {name: artifacts.load(Path(truths) / f"{name}.nc") for name in records}
    compared = score(found, answers)
    artifacts.save(compared, output, origin=found)


if __name__ == "__main__":
    run(main, stick="stick.nc", truths="folder of the bench's truths", output="score.nc")
