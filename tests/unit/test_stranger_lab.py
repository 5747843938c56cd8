"""The stranger's laboratory: its beam in closed form, its decays, its files; it stands apart."""

import ast
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile
from stranger import FAIR, outcome
from stranger_lab import laws, signal
from stranger_lab.bench import Bench
from stranger_lab.files import write_campaign
from stranger_lab.specimen import DENSITY, MODULUS, Beam


def test_a_beam_in_stiff_contact_is_a_clamped_beam():
    length, thickness = 0.3, 0.01
    beam = Beam(length, thickness, 0.022, 0.03)
    found = beam.frequencies(["flap1", "flap2"], 1e12, 1e12, 0.0)
    speed = np.sqrt(MODULUS * thickness**2 / 12 / DENSITY) / (2 * np.pi * length**2)
    assert found == pytest.approx(np.array([1.8751, 4.6941]) ** 2 * speed, rel=0.04)
    assert (beam.frequencies(["flap1"], 1e9, 1e9, 0.0) < found[0]).all()
    assert (beam.frequencies(["flap1"], 1e12, 1e12, 1e4) > found[0]).all()


def test_a_null_decays_with_its_loss_factor():
    bench = Bench(1, kind="null")
    assert bench.effects == {}
    state = bench.state(0)
    omega, eta = signal.rates(bench, bench.visits[0], state, 0)
    path = signal.decay(omega, eta, np.log(1e-5))
    time = np.arange(0, 0.5, 1 / bench.sampling_Hz)
    v = signal.motion(path, omega, time, 0.0, bench.sampling_Hz)
    turn = np.exp(-2j * np.pi * state.frequencies_Hz[0] * time) * v
    cycle = round(bench.sampling_Hz / state.frequencies_Hz[0])
    size = np.abs(np.convolve(turn, np.ones(8 * cycle), "valid"))
    fall = -np.polyfit(time[: len(size)], np.log(size), 1)[0]
    assert fall / (np.pi * state.frequencies_Hz[0]) == pytest.approx(bench.loss[0], rel=0.08)


@pytest.mark.parametrize("name", sorted(laws.SIZES))
def test_every_effect_draws_a_record(name):
    bench = Bench(2, effect=name)
    assert list(bench.effects) == [name]
    assert name in FAIR
    assert np.isfinite(signal.velocity(bench, 0)).all()


def test_a_seed_has_its_files(tmp_path):
    for name in ("a", "b"):
        bench = Bench(3, effect="slip")
        bench.visits = bench.visits[:2]
        write_campaign(bench, tmp_path / name)
    files = sorted(one.relative_to(tmp_path / "a") for one in (tmp_path / "a").rglob("*.*"))
    assert Path("records.csv") in files
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
    rate, samples = wavfile.read(tmp_path / "a" / "raw" / "r001.wav")
    assert (rate, samples.dtype) == (bench.sampling_Hz, np.int16)


def test_outcomes():
    cause = {"mechanism": "joint-slip", "shown": True, "credible_set": ["joint-slip"]}
    named = {"answer": "named", "causes": [cause]}
    assert outcome(["slip"], named) == "right certain"
    assert outcome(["slip", "drag"], named) == "part right"
    assert outcome([], named) == "wrong certain"
    unsure = {"answer": "ambiguous", "possible": {"joint-slip": 0.5}, "causes": []}
    assert outcome(["slip"], unsure) == "ambiguous with truth"
    assert outcome(["drag"], unsure) == "ambiguous without"


def test_it_imports_nothing_of_the_library():
    for path in Path(laws.__file__).parent.glob("*.py"):
        tree = ast.walk(ast.parse(path.read_text()))
        assert not [n for n in tree if isinstance(n, ast.ImportFrom) and "bladeroot" in n.module]
        assert "bladeroot" not in path.read_text()
