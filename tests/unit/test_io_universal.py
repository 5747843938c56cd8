"""Universal files: text and binary, rates, units, several functions."""

import numpy as np
import pytest
from bladeroot.io.read import read
from hypothesis import given, settings
from hypothesis import strategies as st
from record_files import RATE, WAVE, write_universal, write_universal_by_hand


@pytest.mark.parametrize("double", [True, False])
@pytest.mark.parametrize("count", [400, 397])
def test_universal_file_of_text(tmp_path, double, count):
    write_universal(tmp_path / "a.uff", WAVE[:count], RATE, double=double)
    found = read(tmp_path / "a.uff", channel="12:+Z")
    np.testing.assert_allclose(found.samples, WAVE[:count], atol=1e-5 * WAVE.max())
    assert found.sampling_Hz == RATE  # 1.95312e-04 in the file, 2.6 ppm off


@settings(max_examples=40, deadline=None)
@given(
    order=st.sampled_from("<>"),
    double=st.booleans(),
    even=st.booleans(),
    rate=st.sampled_from([1000.0, 5120.0, 25600.0, 51200.0]),
    count=st.integers(64, 700),
    seed=st.integers(0, 2**32 - 1),
)
def test_universal_file_of_either_byte_order(
    tmp_path_factory, order, double, even, rate, count, seed
):
    path = tmp_path_factory.mktemp("order") / "a.uff"
    samples = 0.1 * np.random.default_rng(seed).standard_normal(count)
    write_universal_by_hand(path, samples, rate, order, double, even)
    found = read(path)
    np.testing.assert_allclose(found.samples, samples, rtol=0 if double else 1e-7)
    assert found.sampling_Hz == pytest.approx(rate, rel=1e-12)
    assert found.notes == ()
    data, own, other = path.read_bytes(), *((1, 2) if order == "<" else (2, 1))
    for flag, told in ((3, "byte order 1 or 2"), (other, "no vibration|finite|must rise|uniform")):
        path.write_bytes(data.replace(b"58b     %d" % own, b"58b     %d" % flag))
        with pytest.raises(ValueError, match=told):
            read(path)


def test_universal_file_of_an_odd_rate_says_so(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, 5120.37)
    (note,) = read(tmp_path / "a.uff").notes
    assert "unusual" in note
    found = read(tmp_path / "a.uff", sampling_Hz=5120.37)
    assert found.sampling_Hz == 5120.37
    assert "sampling_Hz 5120.37 as stated is taken" in found.notes[0]


@pytest.mark.parametrize(
    ("increment", "stated", "taken", "notes"),
    [
        ("3.9062E-05", None, 25600.0, 0),
        ("2.27E-05", None, 44000.0, 1),
        ("2.27E-05", 44100.0, 44100.0, 1),
        ("0.0001", None, 10000.0, 0),
    ],
)
def test_universal_increment_of_few_digits(tmp_path, increment, stated, taken, notes):
    write_universal(tmp_path / "a.uff", WAVE, 25600.0)
    text = (tmp_path / "a.uff").read_text()
    written = f"{1 / 25600.0:13.5e}"
    assert text.count(written) == 1
    (tmp_path / "a.uff").write_text(text.replace(written, f"{increment:>13}"))
    found = read(tmp_path / "a.uff", sampling_Hz=stated)
    assert found.sampling_Hz == taken
    assert len(found.notes) == notes
    if increment == "0.0001":
        with pytest.raises(ValueError, match="sampling_Hz contradicts: 16000"):
            read(tmp_path / "a.uff", sampling_Hz=16000.0)


def test_universal_file_of_several_functions(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE)
    write_universal(tmp_path / "b.uff", 3 * WAVE, RATE)
    both = (tmp_path / "a.uff").read_bytes() + (tmp_path / "b.uff").read_bytes()
    (tmp_path / "c.uff").write_bytes(both)
    with pytest.raises(ValueError, match=r"got several of 1: 12:\+Z \[m/s\], 2: 12:\+Z \[m/s\]"):
        read(tmp_path / "c.uff")
    np.testing.assert_allclose(read(tmp_path / "c.uff", channel="2").samples, 3 * WAVE, atol=1e-11)


def test_universal_units_of_data_set_164(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE, unit="NONE")
    with pytest.raises(ValueError, match="expected a unit"):
        read(tmp_path / "a.uff")
    units = "    -1\n   164\n         5mm (milli-newton)           2\n"
    factors = "".join(f"{factor:25.17e}" for factor in (1e3, 1e3, 1.0)) + "\n"
    text = units + factors + f"{273.15:25.17e}\n    -1\n"
    (tmp_path / "b.uff").write_bytes(text.encode() + (tmp_path / "a.uff").read_bytes())
    np.testing.assert_allclose(read(tmp_path / "b.uff").samples, 1e-3 * WAVE, atol=1e-14)


def test_universal_type_contradicts(tmp_path):
    write_universal(tmp_path / "a.uff", WAVE, RATE)
    with pytest.raises(ValueError, match=r"quantity contradicts: acceleration .*velocity in the f"):
        read(tmp_path / "a.uff", quantity="acceleration", channel="1")
