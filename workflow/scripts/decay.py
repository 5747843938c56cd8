"""Frequency and damping against amplitude of one free decay (FREEVIB) -> decay/<record>.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.freevib import freevib, no_decay


def main(record, output):
    cut = artifacts.load(record)
    facts = cut.attrs
    curves = no_decay()
    if facts["verdict"] == "usable":
        velocity = cut["velocity"].values.astype(float)
        try:
            curves = freevib(
                velocity, facts["sampling_Hz"], facts["expected_Hz"], facts["noise_velocity"]
            )
        except ValueError as error:
            facts |= {"verdict": "rejected", "findings": str(error)}
    curves.attrs = {**curves.attrs, **facts}
    artifacts.save(curves, output)


if __name__ == "__main__":
    run(main, record="free decay", output="curves to write")
