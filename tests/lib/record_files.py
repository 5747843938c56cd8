"""Files of every format with one known signal, for the tests of the readers."""

import struct

import netCDF4
import numpy as np

RATE = 5120.0
TIME = np.arange(400) / RATE
WAVE = 0.5 * np.exp(-2 * TIME) * np.sin(2 * np.pi * 100 * TIME)
FORCE = np.cos(2 * np.pi * 50 * TIME)


def write_csv(path, samples, rate, unit="m/s", separator=",", decimal=".", encoding="utf-8"):
    lines = [f"time_s{separator}velocity_{unit}"]
    lines += [
        f"{k / rate:.12g}{separator}{value:.17g}".replace(".", decimal)
        for k, value in enumerate(samples)
    ]
    path.write_bytes(("\n".join(lines) + "\n").encode(encoding))


def write_netcdf(path, samples, rate, unit="m/s", form="NETCDF4"):
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("time", samples.size)
        time = file.createVariable("time", "f8", "time")
        time.units = "s"
        time[:] = np.arange(samples.size) / rate
        velocity = file.createVariable("velocity", "f8", "time")
        velocity.units = unit
        velocity[:] = samples


def write_classic(path, samples, rate, unit="m/s"):
    write_netcdf(path, samples, rate, unit, "NETCDF3_CLASSIC")


def write_tdms(path, samples, rate, unit="m/s"):
    from nptdms import ChannelObject, TdmsWriter

    properties = {"wf_increment": 1.0 / rate, "wf_start_offset": 0.0, "unit_string": unit}
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("run", "laser", samples, properties)])


def write_matlab(path, samples, rate, unit="m/s"):
    from scipy.io import savemat

    savemat(path, {"velocity": samples, "fs": rate, "unit": unit}, do_compression=True)


def write_matlab_73(path, samples, rate, unit="m/s"):
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        file["velocity"] = samples[None, :]
        file["fs"] = np.array([[rate]])
        file["unit"] = np.array([[ord(sign)] for sign in unit], np.uint16)
        file["unit"].attrs["MATLAB_class"] = np.bytes_("char")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def write_universal(path, samples, rate, unit="m/s", binary=0, double=True):
    import pyuff

    path.unlink(missing_ok=True)
    data = pyuff.prepare_58(
        binary=binary,
        func_type=1,
        rsp_node=12,
        rsp_dir=3,
        ref_node=1,
        ref_dir=3,
        data=samples,
        x=np.arange(samples.size) / rate,
        abscissa_spacing=1,
        abscissa_spec_data_type=17,
        ordinate_spec_data_type=11,
        orddenom_spec_data_type=0,
        z_axis_spec_data_type=0,
        ordinate_axis_units_lab=unit,
        ord_data_type=4 if double else 2,
        byte_ordering=1,
        fp_format=2,
        n_ascii_lines=11,
        n_bytes=8 * samples.size,
        return_full_dict=False,
    )
    pyuff.UFF(str(path)).write_sets(data, mode="add", force_double=double)


def write_universal_binary(path, samples, rate, unit="m/s"):
    write_universal(path, samples, rate, unit, binary=1)


def write_universal_by_hand(path, samples, rate, order="<", double=True, even=True):
    """A binary universal file in either byte order, with its times by turns if not even."""
    write_universal(path, samples, rate, binary=1, double=double)
    *head, rest = path.read_bytes().split(b"\n", 13)
    times = np.arange(samples.size) / rate
    numbers = samples if even else np.stack([times, samples], axis=1)
    body = numbers.astype(f"{order}f{8 if double else 4}").tobytes()
    assert rest.endswith(b"    -1\n")
    head[1] = b"    58b%6d%6d%12d%12d%6d%6d%12d%12d" % (
        1 if order == "<" else 2, 2, 11, len(body), 0, 0, 0, 0
    )  # fmt: skip
    head[8] = head[8][:20] + b"%10d" % even + head[8][30:]
    path.write_bytes(b"\n".join([*head, body]) + b"\n    -1\n")


def write_wav(path, samples, rate, unit="m/s", bits=64, order="<"):
    """A WAV of floats (64, 32 bits) or whole numbers of full scale 1."""
    code = 3 if bits == 64 or bits == -32 else 1
    bits = abs(bits)
    frames = np.asarray(samples).reshape(len(samples), -1)
    if code == 3:
        data = frames.astype(f"{order}f{bits // 8}").tobytes()
    elif bits == 8:
        data = np.round(frames * 127 + 128).astype(np.uint8).tobytes()
    else:
        whole = np.round(frames * (2 ** (bits - 1) - 1)).astype(f"{order}i8")
        octets = whole.view(np.uint8).reshape(*frames.shape, 8)
        part = octets[..., : bits // 8] if order == "<" else octets[..., 8 - bits // 8 :]
        data = part.tobytes()
    frame = frames.shape[1] * bits // 8
    form = struct.pack(
        f"{order}HHIIHH", code, frames.shape[1], int(rate), int(rate) * frame, frame, bits
    )
    chunks = b"WAVE" + b"fmt " + struct.pack(f"{order}I", 16) + form
    chunks += b"LIST" + struct.pack(f"{order}I", 3) + b"abc\0"
    chunks += b"data" + struct.pack(f"{order}I", len(data)) + data
    tag = b"RIFF" if order == "<" else b"RIFX"
    path.write_bytes(tag + struct.pack(f"{order}I", len(chunks)) + chunks)


# suffix, writer, and what the sheet must say
FORMATS = {
    "csv": (".csv", write_csv, {}),
    "netcdf": (".nc", write_netcdf, {}),
    "netcdf classic": (".nc", write_classic, {}),
    "tdms": (".tdms", write_tdms, {}),
    "matlab 5": (".mat", write_matlab, {}),
    "matlab 7.3": (".mat", write_matlab_73, {}),
    "universal": (".uff", write_universal, {}),
    "universal binary": (".uff", write_universal_binary, {}),
    "wav": (".wav", write_wav, {"unit": "m/s"}),
}
