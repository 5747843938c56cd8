"""Time and memory of a record's analysis, beside one scipy.signal.hilbert call on it.

    python benchmarks/decay_cost.py                  # about five minutes on one core
    python benchmarks/decay_cost.py --small          # about twenty seconds
    python benchmarks/decay_cost.py --grow rate      # more samples a cycle instead of more cycles
    python benchmarks/decay_cost.py --json benchmarks/decay_cost.json   # keeps the numbers
    python benchmarks/decay_cost.py --page benchmarks/decay_cost.json   # into README.md

Records of 10^5 to 10^7 samples, at lengths that are quick to transform (the hilbert call is at its
best there). Each repeat runs hilbert and every stage in turn, in processor seconds; the smallest
of each counts, for what else runs on the machine only ever adds. "analysis" is all that is done to
a recording in a running process, from its samples to its three artifacts: separation, cut, checks,
curves, second opinion and plateau. The others are its parts, one call each; "curves" are those of
FREEVIB with the separation before.
Memory is the growth of the resident set at its largest in a fresh process (from /proc, so on Linux
only), over the size of the record.
"""

import argparse
import json
import multiprocessing
import os
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from bladeroot.decay.cut import cut
from bladeroot.decay.record import analyse
from bladeroot.plateau.plateau import plateau
from bladeroot.quality.integrity import judge
from bladeroot.quality.peak_fit import peak_fit
from bladeroot.signal.lines import white_noise
from bladeroot.signal.recording import Recording
from foreign_lab.score import with_table
from scipy import signal
from synthetic import EXPECTED_HZ, SAMPLING_HZ, Law, move

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))
from decay_bench import separated_curves

PAGE = Path(__file__).with_name("README.md")
SIZES = (100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
AFTER = {"plateau": "curves", "integrity": "cut"}  # stages that need another's result
# Targets: seconds for the shortest, records' own memory, exponent of growth.
COST_S, MEMORY, SLOPE = 0.15, 10.0, 1.05
KNOWN = {"expected_Hz": EXPECTED_HZ, "other_modes_Hz": (), "simulated": True}
SETTINGS = {"end": "noise"}, {"damping": "hysteretic"}


def make(count: int, grow: str, seed: int = 0) -> tuple[np.ndarray, float]:
    """Velocity that falls to 0.5 % of its start at 60 dB, with a second mode; sampling frequency.

    It grows by cycles (with a lower loss factor) or by samples a cycle.
    """
    sampling_Hz = SAMPLING_HZ if grow == "cycles" else SAMPLING_HZ * count / SIZES[0]
    time_s = np.arange(count) / sampling_Hz
    loss = float(np.log(200.0) / (np.pi * EXPECTED_HZ * time_s[-1]))
    law = Law(EXPECTED_HZ, loss, 0.01, 0.2, "coulomb", 1.5, 0.5 * loss, 1.0)
    level, phase = move(law).at(time_s)
    rng = np.random.default_rng(seed)
    velocity = np.exp(level) * np.cos(phase)
    turn = 6.27 * 2.0 * np.pi * EXPECTED_HZ * time_s
    velocity += 0.2 * np.exp(0.5 * level[0] - 3.0 * loss * EXPECTED_HZ * time_s) * np.cos(turn)
    velocity += 1e-3 / np.sqrt(2.0) * rng.standard_normal(count)
    return 0.5 * velocity, sampling_Hz


def stages(velocity: np.ndarray, sampling_Hz: float) -> dict[str, Callable[[], object]]:
    """What is timed, by name: calls without arguments on one record."""
    noise = white_noise(velocity)
    recording = Recording(velocity, sampling_Hz, "velocity")
    made = {}

    def keep(name: str, value: object) -> None:
        made[name] = value

    calls = {
        "hilbert": lambda: signal.hilbert(velocity),
        "cut": lambda: keep("cut", cut(velocity, sampling_Hz, EXPECTED_HZ)),
        "curves": lambda: keep(
            "curves", separated_curves(velocity, sampling_Hz, EXPECTED_HZ, noise)
        ),
        "plateau": lambda: plateau(made["curves"]),
        "integrity": lambda: judge(made["cut"], velocity, EXPECTED_HZ),
        "peak_fit": lambda: peak_fit(velocity, sampling_Hz, EXPECTED_HZ, noise),
        "analysis": lambda: analyse(recording, KNOWN, *SETTINGS),
    }
    return calls


def seconds(count: int, grow: str, budget_s: float) -> dict[str, float]:
    """Smallest time of each stage over repeats in turn, at least two."""
    calls = stages(*make(count, grow))
    best = dict.fromkeys(calls, np.inf)
    begin, repeats = time.perf_counter(), 0
    while repeats < 2 or (repeats < 40 and time.perf_counter() - begin < budget_s):
        for name, call in calls.items():
            start = time.process_time()
            call()
            best[name] = min(best[name], time.process_time() - start)
        repeats += 1
    return best


def memory(path: str, sampling_Hz: float, name: str) -> float:
    """Growth of the largest resident set by one call, over the record's bytes.

    Runs in a process of its own, in which a short record has loaded all that a call loads.
    """
    for call in stages(*make(20_000, "cycles")).values():
        call()
    velocity = np.load(path)
    calls = stages(velocity, sampling_Hz)
    if name in AFTER:
        calls[AFTER[name]]()
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forget the largest so far
    before = resident("VmRSS")
    calls[name]()
    return (resident("VmHWM") - before) / velocity.nbytes


def resident(kind: str) -> int:
    """Bytes of this process in memory: now (VmRSS) or at most so far (VmHWM)."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return 1024 * int(status.split(f"{kind}:")[1].split()[0])


def apart(count: int, grow: str, names: list[str]) -> dict[str, float]:
    """Memory of each stage, each in a fresh process."""
    os.environ["MALLOC_MMAP_THRESHOLD_"] = "65536"  # what is freed is given back, and counts again
    spawn = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "record.npy"))
        velocity, sampling_Hz = make(count, grow)
        np.save(path, velocity)
        del velocity
        with ProcessPoolExecutor(1, mp_context=spawn, max_tasks_per_child=1) as pool:
            return {name: pool.submit(memory, path, sampling_Hz, name).result() for name in names}


def slope(sizes: list[int], values: list[float]) -> float:
    """Exponent of growth, least squares on log-log."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def measured(sizes: list[int], grow: str, budget_s: float) -> dict:
    """Seconds of each stage by size, and memory of each over the record's, of the largest two."""
    times = {str(count): seconds(count, grow, budget_s) for count in sizes}
    largest = sizes[-1:] if len(sizes) <= 2 else sizes[-2:]
    sized = {str(count): apart(count, grow, list(times[str(count)])) for count in largest}
    return {"grow": grow, "seconds": times, "memory_ratio": sized}


def table(made: dict) -> str:
    """Markdown: time of each stage over hilbert's, its growth, and memory over the record's."""
    times, sized = made["seconds"], made["memory_ratio"]
    names = [name for name in next(iter(times.values())) if name != "hilbert"]
    lines = ["| samples | hilbert s | " + " | ".join(names) + " |", "|---" * (len(names) + 2) + "|"]
    for count, took in times.items():
        ratios = " | ".join(f"{took[name] / took['hilbert']:.3g}" for name in names)
        lines.append(f"| {int(count):,} | {took['hilbert']:.4f} | {ratios} |")
    every = [slope([int(one) for one in times], [took[name] for took in times.values()])
             for name in ("hilbert", *names)]  # fmt: skip
    lines.append("| slope | " + " | ".join(f"{one:.2f}" for one in every) + " |")
    for count, found in sized.items():
        cells = " | ".join(f"{found[name]:.1f}" for name in ("hilbert", *names))
        lines.append(f"| memory over the record's, {int(count):,} | {cells} |")
    return "\n".join(lines) + "\n"


def judged(made: dict) -> list[str]:
    """Each target, what was measured, and whether it is met."""
    times, sized = made["seconds"], made["memory_ratio"]
    sizes, whole = [int(one) for one in times], [took["analysis"] for took in times.values()]
    lines = [
        f"a record of {sizes[0]:,} samples, all of its analysis: {whole[0]:.3f} s, at most "
        f"{COST_S:g} s: {_verdict(whole[0] <= COST_S)}"
    ]
    if len(sizes) > 2:
        growth = slope(sizes, whole)
        lines.append(
            f"its time grows with an exponent of {growth:.2f}, at most {SLOPE:g}: "
            f"{_verdict(growth <= SLOPE)}"
        )
    largest = max(own for name, own in list(sized.values())[-1].items() if name != "hilbert")
    lines.append(f"memory {largest:.1f} records, at most {MEMORY:g}: {_verdict(largest <= MEMORY)}")
    return lines


def _verdict(good: bool) -> str:
    return "ok" if good else "FAILS"


def paged(made: dict) -> str:
    """README.md with the table and the targets."""
    said = "".join(f"- {line}\n" for line in judged(made))
    return with_table(PAGE.read_text(), "decay_cost", f"{table(made)}\n{said}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grow", choices=("cycles", "rate"), default="cycles")
    parser.add_argument("--small", action="store_true", help="10^5 and 3 x 10^5 samples")
    parser.add_argument("--budget", type=float, default=20.0, help="seconds of repeats a size")
    parser.add_argument("--json", type=Path, help="where the numbers go, too")
    parser.add_argument("--page", type=Path, help="numbers that go into README.md")
    options = parser.parse_args()
    if options.page:
        PAGE.write_text(paged(json.loads(options.page.read_text())))
        return
    sizes = list(SIZES[:2] if options.small else SIZES)
    made = measured(sizes, options.grow, 1.0 if options.small else options.budget)
    print(f"records grow by {options.grow}; time over that of scipy.signal.hilbert\n")
    print(table(made), *judged(made), sep="\n")
    if options.json:
        options.json.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
