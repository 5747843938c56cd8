"""The free decay of one raw record -> records/<record>.nc."""

import json

import numpy as np
from _cli import run
from bladeroot import artifacts
from bladeroot.records.cut import cut, rejected
from bladeroot.records.integrity import bridged, judge
from bladeroot.records.overrides import kept, overruled, windowed, with_override
from bladeroot.records.read import read
from bladeroot.records.recording import velocity

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
        motion = velocity(recording, expected)
        clear = bridged(motion, recording.sampling_Hz, expected)
        decay = cut(clear, recording.sampling_Hz, expected, **json.loads(settings))
        others = tuple(known["other_modes_Hz"])
        decay = windowed(decay, clear, known["start_s"], known["end_s"])
        decay = judge(decay, motion, expected, others, recording.notes, recording)
    decay = kept(decay) if known["keep"] else decay
    decay = with_override(decay, overruled(known))
    decay.attrs |= {
        "record": known["record"],
        "mode": known["mode"],
        "expected_Hz": expected,
        "load": known["load"],
        **known["load_facts"],
        "hold": known["hold"],
        "direction": known["direction"],
        "event": known["event"],
        "group": known["group"],
        "sensor": known["sensor"],
        "simulated": int(known["simulated"]),
        "campaign": campaign,
    }
    if known["force_N"] is not None:
        decay.attrs["force_N"] = known["force_N"]
    if known["band_Hz"] is not None:
        decay.attrs["band_Hz"] = known["band_Hz"]
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
