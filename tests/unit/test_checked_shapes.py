"""The checker of shapes that CI runs the unit tests with."""

import os
import subprocess
import sys

WRONG = """
import shapes
shapes.check_outer_functions_at_first()
import jaxtyping, numpy as np
with jaxtyping.install_import_hook("bladeroot", "shapes.checked"):
    from bladeroot.inference.problem import Prior
    from bladeroot.signal.runs import medians
one, row = np.zeros(1), np.zeros((1, 1))
for call in (lambda: medians("x"), lambda: Prior(one, row)):
    try:
        call()
    except jaxtyping.TypeCheckError:
        continue
    raise SystemExit("not refused")
for _ in range(shapes.FIRST):
    Prior(one, one)
Prior(one, row)
"""


def test_wrong_shapes_are_refused_in_the_first_calls():
    here = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, "-c", WRONG], env=here, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
