"""Frequency and damping against amplitude of one free decay (FREEVIB) -> decay/<record>.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.freevib import freevib, no_decay


def main(record, output):
    cut = artifacts.load(record)
    facts = cut.attrs
    if facts["verdict"] == "rejected":
        curves = no_decay()
    else:
        curves = freevib(
            cut["velocity"].values.astype(float),
            facts["sampling_Hz"],
            facts["expected_Hz"],
            facts["noise_velocity"],
        )
    curves.attrs = {**facts, **curves.attrs}
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(main, record="free decay", output="curves to write")
