"""Raw records that lead elsewhere, hold themselves, claim what is not there, or say no numbers."""

import resource

import h5py
import netCDF4
import numpy as np
import pytest
from answers import answer
from bladeroot.hdf5_links import DEEPEST, MOST_OBJECTS
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
    file["/".join("g" * (DEEPEST + 2))] = 1.0


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
}
SLOW = {"many objects"}


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
