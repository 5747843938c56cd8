"""Raw records that lead elsewhere, hold themselves, claim what is not there, or say no numbers."""
# ruff: noqa: E501

import resource
import struct
import zlib

import h5py
import netCDF4
import numpy as np
import pytest
from answers import answer
from bladeroot.hdf5_links import DEEPEST_GROUP, MOST_OBJECTS
from bladeroot.io.read import read
from record_files import write_csv, write_matlab_73, write_netcdf

RATE = 5120.0
TIME = np.arange(600) / RATE
WAVE = 0.5 * np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME)


def within(change, write=write_matlab_73):
    """A good file, changed by `change(open file, folder)`."""

    def make(path, folder):
        write(path, WAVE, RATE)
        with h5py.File(path, "a") as file:
            change(file, folder)

    return make


def elsewhere(folder):
    write_matlab_73(folder / "other.mat", 7.0 * WAVE, RATE)
    return str(folder / "other.mat")


def loop(file, folder):
    file["run/inner/again"] = 1.0
    file["run/inner/back"] = file["run"]


def external(file, folder):
    del file["velocity"]
    file["velocity"] = h5py.ExternalLink(elsewhere(folder), "/velocity")


def beside(file, folder):
    file["more"] = h5py.ExternalLink(elsewhere(folder), "/")


def raw_elsewhere(file, folder):
    (folder / "raw").write_bytes(WAVE.tobytes())
    del file["velocity"]
    file.create_dataset(
        "velocity", (1, 600), "f8", external=[(str(folder / "raw"), 0, h5py.h5f.UNLIMITED)]
    )


def virtual(file, folder):
    layout = h5py.VirtualLayout((1, 600), "f8")
    layout[:] = h5py.VirtualSource(elsewhere(folder), "velocity", (1, 600))
    del file["velocity"]
    file.create_virtual_dataset("velocity", layout)


def many(file, folder):
    for k in range(MOST_OBJECTS + 1):
        file[f"n{k}"] = h5py.SoftLink("/nowhere")


def deep(file, folder):
    file["/".join("g" * (DEEPEST_GROUP + 2))] = 1.0


def fan(file, folder):
    """Two names a level for one group: a thousand ways to the same place."""
    group = file
    for _ in range(10):
        inner = group.create_group("a")
        group["b"] = inner
        group = inner


def soft(file, folder):
    file["gone"] = h5py.SoftLink("/nowhere")


def self_soft(file, folder):
    file["me"] = h5py.SoftLink("/")


def attribute(name, value, packed=True):
    def make(path, folder):
        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("time", WAVE.size)
            velocity = file.createVariable("velocity", "i2" if packed else "f8", "time")
            velocity.set_auto_maskandscale(False)
            velocity[:] = np.round(30000 * WAVE).astype(int) if packed else WAVE
            velocity.units = "mm/s"
            velocity.setncattr(name, value)
            file.sampling_Hz = RATE

    return make


def lines_of(text):
    return lambda path, folder: path.write_text(text)


def csv(old, new, count=1):
    def make(path, folder):
        write_csv(path, WAVE, RATE)
        path.write_text(path.read_text().replace(old, new, count))

    return make


def claimed(suffix, size):
    """Zeros by the gigabyte in a file of some kilobytes, as its header has them."""

    def make(path, folder):
        if suffix == ".mat":  # a compressed variable of version 5: its own tag says how long it is
            inner = zlib.compress(struct.pack("<II", 14, size) + bytes(4096))
            tag = struct.pack("<II", 15, len(inner))
            path.write_bytes(b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + tag + inner)
            return
        with h5py.File(path, "w") as file:
            file.create_dataset("velocity", (size // 8,), "f8", chunks=(10**6,), compression="gzip")
            file.attrs["sampling_Hz"] = RATE

    return make


def wav(**changes):
    """A RIFF file by hand, with what its header must not say."""
    own = {
        "form": 1,
        "channels": 1,
        "rate": 5120,
        "frame": 2,
        "bits": 16,
        "junk": b"",
        "size": 1200,
    }
    own |= changes

    def make(path, folder):
        form = struct.pack("<HHIIHH", own["form"], own["channels"], own["rate"],
                           own["rate"] * own["frame"] % 2**32, own["frame"], own["bits"])  # fmt: skip
        data = (30000 * WAVE).astype("<i2").tobytes()
        body = b"fmt " + struct.pack("<I", 16) + form + own["junk"]
        body += b"data" + struct.pack("<I", own["size"]) + data
        path.write_bytes(b"RIFF" + struct.pack("<I", len(body) + 4) + b"WAVE" + body)

    return make


def tdms(content):
    return lambda path, folder: path.write_bytes(content)


def columns(time, values, head="time_s,velocity_m/s"):
    return lines_of("\n".join([head, *(f"{t},{v}" for t, v in zip(time, values, strict=True)), ""]))


# suffix, how the file is made, and what is said of it ("" where it is read)
CASES = {
    "loop of groups, matlab": (".mat", within(loop), "holds itself"),
    "loop of groups, netcdf": (".nc", within(loop, write_netcdf), "holds itself"),
    "link to another file": (".mat", within(external), "link to another"),
    "link to another file, netcdf": (".nc", within(beside, write_netcdf), "link to another"),
    "link beside": (".mat", within(beside), "link to another"),
    "numbers in another file": (".mat", within(raw_elsewhere), "in other files"),
    "virtual numbers": (".mat", within(virtual), "in other files"),
    "many objects": (".mat", within(many), "at most"),
    "deep groups": (".mat", within(deep), "deep at most"),
    "deep groups, netcdf": (".nc", within(deep, write_netcdf), "deep at most"),
    "many ways to one group": (".mat", within(fan), "two names"),
    "many ways to one group, netcdf": (".nc", within(fan, write_netcdf), "two names"),
    "link to nowhere": (".mat", within(soft), ""),
    "link to the root": (".mat", within(self_soft), ""),
    "scale is a text": (".nc", attribute("scale_factor", "0.001"), "scale_factor"),
    "scale is a word": (".nc", attribute("scale_factor", "milli"), "scale_factor"),
    "scale is two numbers": (".nc", attribute("scale_factor", [1.0, 2.0]), "scale_factor"),
    "scale is nan": (".nc", attribute("scale_factor", np.nan), "scale_factor"),
    "scale is infinite": (".nc", attribute("scale_factor", np.inf), "scale_factor"),
    "scale is empty": (".nc", attribute("scale_factor", ""), "scale_factor"),
    "scale of floats is a text": (".nc", attribute("scale_factor", "1", False), "scale_factor"),
    "offset is a text": (".nc", attribute("add_offset", "1"), "add_offset"),
    "fill value is a text": (".nc", attribute("missing_value", "none"), "missing_value"),
    "range is a text": (".nc", attribute("valid_range", "0 to 1"), "valid_range"),
    "scale is nothing": (".nc", attribute("scale_factor", 0.0), "vary"),
    "scale is a number": (".nc", attribute("scale_factor", 0.001), ""),
    "units is a number": (".nc", attribute("units", 7.0), "unit"),
    "sampling is a script": (".nc", attribute("units", "<script>"), "unit"),
    "a number of 400 digits": (".csv", csv("\n0.05,", "\n0.05" + "9" * 400 + ","), ""),
    "a sample of 400 digits": (".csv", csv(",-0.", "," + "9" * 400 + "."), "finite"),
    "a name of 5000 signs": (".csv", csv("velocity", "v" * 5000), ""),
    "a header of a tag": (".csv", csv("velocity", "<script>velocity"), ""),
    "a line of a million": (".csv", lines_of("1," * 1_000_000 + "\n"), "bad.csv"),
    "a rate of 400 digits": (
        ".csv",
        lines_of("fs: " + "9" * 400 + "\nv_m/s\n" + "1\n2\n" * 99),
        "",
    ),
    "commas alone": (".csv", lines_of("," * 99999), "bad.csv"),
    "quotes alone": (".csv", lines_of('"' * 99999 + "\n"), "bad.csv"),
    "16 GB of nothing, matlab": (".mat", claimed(".h5", 16 * 10**9), "claims"),
    "16 GB of nothing, netcdf": (".nc", claimed(".h5", 16 * 10**9), "claims"),
    "4 GB of zeros, matlab 5": (".mat", claimed(".mat", 4 * 10**9), "claims"),
    "wav of 4 GB": (".wav", wav(size=0xFFFFFFF0), "cut off"),
    "wav without channels": (".wav", wav(channels=0, frame=0), "expected"),
    "wav of many channels": (".wav", wav(channels=65535), "expected"),
    "wav of 7 bits": (".wav", wav(bits=7), "7 bits"),
    "wav of an unknown form": (".wav", wav(form=0x1234), "expected"),
    "wav of no frame": (".wav", wav(frame=0), "expected"),
    "wav without samples": (".wav", wav(size=0), "sensitivity"),
    "wav, a chunk beyond the end": (".wav", wav(junk=b"junk\xff\xff\xff\xff"), "ends before"),
    "wav, the rates differ": (".wav", wav(rate=0xFFFFFFFF), "bytes a second"),
    "tdms of 2^63 bytes": (
        ".tdms",
        tdms(b"TDSm" + struct.pack("<IIQQ", 14, 4713, 2**63, 2**62)),
        "cut off",
    ),
    "tdms of zeros": (".tdms", tdms(bytes(4096)), "segment"),
    "tdms of empty segments": (
        ".tdms",
        tdms((b"TDSm" + struct.pack("<IIQQ", 14, 4713, 0, 0)) * 500),
        "bad.tdms",
    ),
    "time that falls": (".csv", columns(TIME[::-1], WAVE), "rise"),
    "time that stands": (".csv", columns(np.ones(600), WAVE), "rise"),
    "time that leaps": (".csv", columns([*TIME[:-1], 1e300], WAVE), "steps"),
    "time without end": (".csv", columns([*TIME[:-1], "inf"], WAVE), "finite"),
    "arabic digits": (".csv", columns(TIME, ["\u0661.\u0662"] * 600), "finite"),
    "subnormal samples": (".csv", columns(TIME, 1e-315 * WAVE), ""),
    "zero bytes": (".csv", tdms(b"time_s,velocity_m/s\n" + bytes(5000)), "zero bytes"),
    "gzip in disguise": (".csv", tdms(b"\x1f\x8b\x08\x00" + bytes(range(256)) * 9), "zero bytes"),
    "fifty thousand columns": (
        ".csv",
        lines_of(",".join(["v"] * 50_000) + "\n" + "1,2\n" * 20),
        "bad.csv",
    ),
    "a million blank lines": (
        ".csv",
        lines_of("time_s,velocity_m/s\n" + "\n" * 1_000_000),
        "bad.csv",
    ),
    "complex samples": (
        ".mat",
        within(lambda f, _: (f.pop("velocity"), f.create_dataset("velocity", data=WAVE + 1j))),
        "real numbers",
    ),
    "samples that are bytes": (
        ".mat",
        within(
            lambda f, _: (
                f.pop("velocity"),
                f.create_dataset("velocity", data=np.array([b"a"] * 600)),
            )
        ),
        "real numbers",
    ),
    "dataset of lists": (
        ".mat",
        within(
            lambda f, _: (
                f.pop("velocity"),
                f.create_dataset("velocity", (600,), h5py.vlen_dtype("f8")),
            )
        ),
        "bad.mat",
    ),
    "universal file of nothing": (".unv", lines_of("    -1\n    -1\n"), "bad.unv"),
    "universal file, a count below zero": (
        ".unv",
        lines_of("    -1\n    58\n" + "x\n" * 6 + "         4        -5         1\n    -1\n"),
        "bad.unv",
    ),
}
SLOW = {"many objects", "a million blank lines", "fifty thousand columns"}


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in CASES]
)
def test_record(case, tmp_path):
    suffix, make, told = CASES[case]
    path = tmp_path / f"bad{suffix}"
    make(path, tmp_path)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    lines = answer(lambda: read(path), path.name, told)
    assert len(lines) <= 1
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 500_000  # kB
