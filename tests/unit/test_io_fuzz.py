"""Damaged files of every format: a record, or one line; never another curve without a word.

What reading cannot see: samples that are damaged themselves (the integrity findings look for
those), and a number of the header that became another plausible one.
"""

import os
import signal
import time
import tracemalloc

import netCDF4
import numpy as np
import pytest
import xarray as xr
from bladeroot.io import hdf5
from bladeroot.io.read import read
from record_files import FORMATS, write_matlab_73, write_tdms, write_universal, write_wav

RATE = 5120.0
TIME = np.arange(600) / RATE
NOISE = 1e-5 * np.random.default_rng(0).standard_normal(TIME.size)
WAVE = 0.5 * np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME) + NOISE


def cut(data, draw):
    return data[: draw.integers(len(data))]


def flip_bits(data, draw):
    changed = bytearray(data)
    for at in draw.integers(0, len(data), draw.integers(1, 4)):
        changed[at] ^= 1 << draw.integers(8)
    return bytes(changed)


def spoil_header(data, draw):
    changed = bytearray(data)
    for at in draw.integers(0, min(len(data), 1500), draw.integers(1, 4)):
        changed[at] = draw.integers(256)
    return bytes(changed)


def extremes(data, draw):
    changed, at = bytearray(data), draw.integers(0, min(len(data), 1500))
    width = int(draw.choice([2, 4, 8]))
    changed[at : at + width] = bytes([draw.choice([0, 0xFF, 0x7F])]) * width
    return bytes(changed)


def swap_blocks(data, draw):
    size = int(draw.choice([8, 64, 512, 4096]))
    a, b = sorted(draw.integers(0, max(len(data) - size, 1), 2))
    return (
        data[:a] + data[b : b + size] + data[a + size : b] + data[a : a + size] + data[b + size :]
    )


def put_in(data, draw):
    at, more = draw.integers(len(data)), draw.integers(0, 256, draw.integers(1, 64))
    return data[:at] + more.astype(np.uint8).tobytes() + data[at:]


def take_out(data, draw):
    at = draw.integers(len(data))
    return data[:at] + data[at + int(draw.choice([1, 8, 100, 1000])) :]


DAMAGES = (cut, flip_bits, spoil_header, extremes, swap_blocks, put_in, take_out)
# These move or replace samples where the file has no times to tell.
ON_SAMPLES = (swap_blocks, put_in, take_out)


def verdict(path, told):
    """What came of a damaged file, in a word."""
    try:
        found = read(path, **told)
    except ValueError as error:
        one_line = "\n" not in str(error) and path.name in str(error)
        return "refused" if one_line else f"badly told: {error}"
    assert np.isfinite(found.samples).all()
    if found.notes or found.lost.size:
        return "noted"
    count = min(found.samples.size, WAVE.size)
    if found.sampling_Hz != RATE or found.quantity != "velocity" or count < found.samples.size:
        return "another scale"
    if abs(np.median(found.samples[:count] / WAVE[:count]) - 1.0) > 1e-3:
        return "another scale"
    changed = (np.abs(found.samples[:count] - WAVE[:count]) > 1e-6).sum()
    return "good" if not changed else "few samples" if changed <= 8 else "many samples"


def damaged(folder, name, cases, seed):
    """Count of every verdict, by the kind of damage."""
    suffix, write, told = FORMATS[name]
    path = folder / f"good{suffix}"
    write(path, WAVE, RATE)
    data, counts = path.read_bytes(), {}
    draw = np.random.default_rng(seed)
    for case in range(cases):
        damage = DAMAGES[case % len(DAMAGES)]
        # never one name twice: the HDF5 library may remember a file
        path = folder / f"bad{case}{suffix}"
        path.write_bytes(damage(data, draw) or b"\n")
        key = (damage, verdict(path, told))
        counts[key] = counts.get(key, 0) + 1
    return counts


@pytest.mark.parametrize("name", FORMATS)
def test_damage_is_refused_noted_or_harmless(tmp_path, name):
    for (damage, found), count in damaged(tmp_path, name, 42, seed=1).items():
        assert found in ("refused", "noted", "good", "few samples", "many samples"), (damage, count)
        assert found != "many samples" or damage in ON_SAMPLES


@pytest.mark.suite
@pytest.mark.parametrize("name", FORMATS)
def test_much_damage(tmp_path, name, monkeypatch):
    monkeypatch.setattr(hdf5, "PATIENCE_S", 1.0)
    counts = damaged(tmp_path, name, 1050, seed=2)
    assert not [found for _, found in counts if found.startswith("badly told")]
    unseen = {key: n for key, n in counts.items() if key[1] in ("another scale", "many samples")}
    assert sum(n for (damage, _), n in unseen.items() if damage not in ON_SAMPLES) <= 0.006 * 1050
    assert sum(unseen.values()) <= 0.03 * 1050


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("content", [b"", b"\n", b"\0" * 5000, b"\xff" * 5000, b"PK\x03\x04" * 99])
def test_what_is_no_file_of_the_format(tmp_path, name, content):
    suffix, _, told = FORMATS[name]
    path = tmp_path / f"bad{suffix}"
    path.write_bytes(content)
    assert verdict(path, told) == "refused"


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("other", FORMATS)
def test_a_wrong_suffix(tmp_path, name, other):
    suffix, write, _ = FORMATS[name]
    wrong, _, told = FORMATS[other]
    write(tmp_path / f"good{suffix}", WAVE, RATE)
    path = (tmp_path / f"good{suffix}").rename(tmp_path / f"renamed{wrong}")
    assert verdict(path, told) == ("good" if _alike(name, other) else "refused")


def _alike(name, other):
    families = ("netcdf", "matlab", "universal")
    return name == other or any(f in name and f in other for f in families)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        (name, value)
        for name in FORMATS
        for value in (np.nan, np.inf, -np.inf, 1e300)
        # the writer of universal files replaces what is not finite
        if np.isfinite(value) or not name.startswith("universal")
    ],
)
def test_values_that_are_none(tmp_path, name, value):
    suffix, write, told = FORMATS[name]
    samples = WAVE.copy()
    samples[300] = value
    write(tmp_path / f"bad{suffix}", samples, RATE)
    assert verdict(tmp_path / f"bad{suffix}", told) == ("refused" if value == 1e300 else "noted")


def claim_hdf5(path, samples, rate):
    import h5py

    write_matlab_73(path, samples, rate)
    with h5py.File(path, "a") as file:
        del file["velocity"]
        file.create_dataset("velocity", (1, 10**12), "f8", chunks=(1, 4096), compression="gzip")


def claim_netcdf(path, samples, rate):
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 10**11)
        file.createVariable("velocity", "f8", "time", zlib=True, chunksizes=(4096,)).units = "m/s"
        file.sampling_Hz = rate


def claim_wav(path, samples, rate):
    write_wav(path, samples, rate)
    data = path.read_bytes()
    large = b"ds64" + (28).to_bytes(4, "little") + (10**13).to_bytes(8, "little") * 3 + b"\0" * 4
    at = data.index(b"data") + 4
    path.write_bytes(b"RF64" + data[4:12] + large + data[12:at] + b"\xff" * 4 + data[at + 4 :])


def claim_universal(path, samples, rate):
    write_universal(path, samples, rate)
    path.write_bytes(path.read_bytes().replace(b"%10d" % 600, b"%10d" % (10**9), 1))


def claim_tdms(path, samples, rate):
    write_tdms(path, samples, rate)
    count = (600).to_bytes(8, "little")
    path.write_bytes(path.read_bytes().replace(count, (10**12).to_bytes(8, "little"), 1))


@pytest.mark.parametrize(
    ("suffix", "write"),
    [
        (".mat", claim_hdf5),
        (".nc", claim_netcdf),
        (".wav", claim_wav),
        (".uff", claim_universal),
        (".tdms", claim_tdms),
    ],
)
def test_a_header_that_claims_more_than_there_is(tmp_path, suffix, write):
    path = tmp_path / f"huge{suffix}"
    write(path, WAVE, RATE)
    tracemalloc.start()
    try:
        # a TDMS segment may say what it would hold and still end sooner
        assert verdict(path, {}) in ("refused", "good" if suffix == ".tdms" else "refused")
        assert tracemalloc.get_traced_memory()[1] < 5e7
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("work", "told"),
    [
        (lambda: time.sleep(60), "reading does not end after 0 s"),
        (lambda: os.kill(os.getpid(), signal.SIGKILL), r"crash \(SIGKILL\)"),
    ],
)
def test_a_library_that_does_not_come_back(tmp_path, monkeypatch, work, told):
    (tmp_path / "a.nc").touch()
    monkeypatch.setattr(hdf5, "PATIENCE_S", 0.05)
    with pytest.raises(ValueError, match=told):
        hdf5.try_first(work, str(tmp_path / "a.nc"))


@pytest.mark.parametrize("caught", [False, True])
def test_files_are_tried_together_or_else_one_by_one(tmp_path, monkeypatch, caught):
    """One child reads all; where a file catches it, each is tried by itself again."""
    monkeypatch.setattr(hdf5, "PATIENCE_S", 0.05)
    monkeypatch.setattr(hdf5, "_TRIED", set())
    paths = [str(tmp_path / f"{name}.nc") for name in "ab"]
    for path in paths:
        xr.Dataset({"v": ("t", np.arange(9.0))}).to_netcdf(path)
    (tmp_path / "c.csv").write_text("1")

    def work(path):
        if path.endswith("a.nc"):
            raise ValueError("met again")
        time.sleep(60 if caught else 0)

    asked = [*paths, str(tmp_path / "c.csv"), str(tmp_path / "none.nc")]
    hdf5.try_together(work, [(path,) for path in asked])
    alone = []
    for path in paths:
        hdf5.try_first(lambda: (tmp_path / "alone").touch(), path)
        alone.append((tmp_path / "alone").exists())
    assert alone == [caught, caught]
