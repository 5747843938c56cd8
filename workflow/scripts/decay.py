"""FREEVIB curves of one free decay, and its plateau -> decay/<record>.nc, plateau/<record>.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.freevib import freevib, no_decay
from bladeroot.decay.record import record_plateau


def main(record, decay, plateau):
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
    artifacts.save(record_plateau(curves), plateau)
    artifacts.save(curves, decay)


if __name__ == "__main__":
    run(main, record="free decay", decay="curves to write", plateau="plateau to write")
