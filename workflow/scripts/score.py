"""Stick frequencies of simulated records beside the bench's truth -> score.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.report.score import score


def main(stick, truths, output):
    answers = [artifacts.load(truth) for truth in truths]
    found = artifacts.load(stick)
    compared = score(found, {str(answer["record"].item()): answer for answer in answers})
    artifacts.save(compared, output, origin=found)


if __name__ == "__main__":
    run(main, stick="stick.nc", truths="many: the bench's truths", output="score.nc")
