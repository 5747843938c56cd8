"""The free decay of one raw record -> records/<record>.nc."""

import json

import numpy as np
from _cli import run
from bladeroot import artifacts
from bladeroot.records.cut import rejected
from bladeroot.records.free_decay import free_decay
from bladeroot.records.integrity import judge
from bladeroot.records.read import read

# What the sheet says of a raw file; the file may contradict it.
SAID = ("quantity", "unit", "channel", "sampling_Hz", "sensitivity", "mode", "force_N")


def main(raw, facts, campaign, settings, output):
    known = json.loads(facts)
    expected = known["expected_Hz"]
    try:
        recording = read(raw, **{name: known[name] for name in SAID})
    except ValueError as error:
        decay = judge(rejected(str(error)), np.zeros(0), expected)
    else:
        others = tuple(known["other_modes_Hz"])
        decay = free_decay(recording, expected, others, **json.loads(settings))
    decay.attrs |= {
        "record": known["record"],
        "mode": known["mode"],
        "expected_Hz": expected,
        "force_N": known["force_N"],
        "hold": known["hold"],
        "direction": known["direction"],
        "simulated": int(known["simulated"]),
        "campaign": campaign,
    }
    artifacts.save(decay, output, settings=settings)


if __name__ == "__main__":
    run(
        main,
        raw="raw file",
        facts="what is known of the record besides its samples (JSON)",
        campaign="the campaign's name",
        settings="section `record` of the configuration (JSON)",
        output="free decay to write",
    )
