"""Stick frequencies of simulated records beside the bench's truth -> score.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.report.score import score


def main(stick, truths, output):
    answers = [artifacts.load(truth) for truth in truths]
    artifacts.save(
        score(artifacts.load(stick), {str(answer["record"].item()): answer for answer in answers}),
        output,
    )


if __name__ == "__main__":
    run(main, stick="stick.nc", truths="many: the bench's truths", output="score.nc")
