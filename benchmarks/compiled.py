"""What each compiled function saves: the same work with and without compiling, a process each.

python benchmarks/compiled.py
"""

import ast
import cProfile
import os
import pstats
import subprocess
import sys
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lib"))

import bladeroot as br
import numpy as np
from bladeroot.bench.bench import simulate
from bladeroot.bench.joint import parts
from bladeroot.nonlinear.curves import mode_curve
from bladeroot.nonlinear.flanks import FlankContact, flank_sliders
from bladeroot.nonlinear.system import system_of
from nonlinear_systems import coarse_joint
from rig_toy import ROW, toy_bench, toy_reduced

LIBRARY = Path(br.__file__).parent
POINT = np.array([np.log(2e9), np.log(2e9), 12e3])


def curve(method):
    """Ten amplitudes of the coarse dovetail's 1B with friction at all its flanks."""
    system = system_of(coarse_joint(), POINT, "1B", 0.0)
    sliders = flank_sliders(coarse_joint(), system, POINT, FlankContact("jenkins", 0.42, 0.5))
    mode_curve(system, sliders, np.geomspace(1e-7, 1e-4, 10), method, (1, 3))


WORK = {
    "a curve by harmonic balance": lambda: curve("harmonic-balance"),
    "a curve by loading": lambda: curve("quasi-static"),
    "a simulated record of a small bench": lambda: simulate(toy_bench(), parts(toy_reduced()), ROW),
}


def compiled() -> set[tuple[str, str]]:
    """File and name of every function that is compiled."""
    return {
        (str(path), node.name)
        for path in LIBRARY.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef)
        and any("njit" in ast.dump(one) for one in node.decorator_list)
    }


def measure(name: str) -> None:
    """Print CPU seconds of some work and, where nothing is compiled, of each function in it."""
    plain, profile = os.environ.get("NUMBA_DISABLE_JIT"), cProfile.Profile(time.process_time)
    if not plain:
        WORK[name]()  # compiled, or read from the cache
    began = time.process_time()
    profile.runcall(WORK[name]) if plain else WORK[name]()
    print(f"  {time.process_time() - began:8.3f} CPU s")
    if plain:
        found, known = pstats.Stats(profile).stats, compiled()
        own = {(file, f): row[2] for (file, _, f), row in found.items() if (file, f) in known}
        for (file, f), seconds in sorted(own.items(), key=lambda pair: -pair[1]):
            print(f"  {seconds:12.3f} in {Path(file).relative_to(LIBRARY)}, {f}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        measure(sys.argv[1])
    for name in WORK if len(sys.argv) == 1 else ():
        for how, more in (("compiled", {}), ("plain, profiled", {"NUMBA_DISABLE_JIT": "1"})):
            print(f"{name}, {how}", flush=True)
            subprocess.run([sys.executable, __file__, name], env=os.environ | more, check=True)
