"""The rows of records.csv: one record each, or one for each mode and channel that a row names."""

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from bladeroot.io.cells import Cells
from bladeroot.io.expected import expected_at
from bladeroot.io.load import COLUMNS
from bladeroot.io.names import ID_RULE, SPECIAL, SPECIAL_TEXT, is_id, is_there, short
from bladeroot.io.overrides import overruled
from bladeroot.io.read import formats, read
from bladeroot.io.responses import undoing
from bladeroot.io.sheet import REMARK
from bladeroot.io.units import USUAL, motion, sensitivity_of
from bladeroot.signal.recording import SI

RECORD_COLUMNS = (
    "record", "file", "mode", *COLUMNS, "clamping", "hold", "event", "group", "direction", "time_s",
    "drive_A", "quantity", "unit", "sensitivity", "response", "sampling_Hz", "channel", "sensor",
    "from_s", "to_s", "start_s", "end_s", "band_Hz", "keep", "exclude",
)  # fmt: skip
# Signs of a channel's name in a record's: file systems allow 255 bytes.
LONGEST_CHANNEL = 60
# Relative difference of loads below which they are rather readings of one than two of a test.
SAME_LOAD = 0.01
_FOREIGN = re.compile(r"[^A-Za-z0-9_]+")
# Columns in which the rows of one event must agree.
_EVENT_COLUMNS = ("direction", "time_s", "group", "hold", "load", "temperature_C")


@dataclass(frozen=True)
class RecordRows(Cells):
    """Checks of records.csv."""

    def records(self, rows: list[tuple[int, dict]]) -> tuple[dict, ...]:
        """One dict a record, numbers in SI units and the load in its own."""
        if not self.required(rows, ("record", "file", "mode")):
            return ()
        if rows and {"hold", "clamping"} <= set(rows[0][1]):
            self.fault("clamping and hold name the same thing; one of the columns must go", 1)
            return ()
        checked: list[dict] = []
        places: list[int] = []
        first_row: dict[str, int] = {}
        naming: dict[str, bool] = {}
        for row, values in rows:
            record = values["record"]
            if not is_id(record):
                self.fault(f"record must be {ID_RULE}, got {short(record)!r}", row)
                continue
            for line in self._row(row, values, naming):
                name = line["record"].lower()  # some disks do not tell a from A
                self.once(row, name, first_row, f"record {line['record']!r}")
                checked.append(line)
                places.append(row)
        self._one_use(rows)
        if not self.faults:
            self._events(places, checked)
            self._near_loads(places, checked)
        return tuple(checked)

    def _row(self, row: int, values: dict, naming: dict[str, bool]) -> list[dict]:
        """The records of one row."""
        record = values["record"]
        common = {
            "file": self._raw_file(row, record, values["file"]),
            **self._load(row, values),
            "direction": self.choice(row, values, "direction", ("up", "down"), ""),
            "time_s": self.optional_number(row, values, "time_s"),
            "drive_A": self.optional_number(row, values, "drive_A"),
            **self._quantity(row, values),
            "response": self._response(row, values),
            "sampling_Hz": self.optional_number(row, values, "sampling_Hz", positive=True),
            "group": self._name(row, values, "group"),
            "temperature_C": self.optional_number(row, values, "temperature_C"),
            **self._window(row, values),
            "keep": self.yes(row, values, "keep"),
            "exclude": self.yes(row, values, "exclude"),
        }
        if overruled(common):
            common["note"] = "; ".join(
                text for name, text in values.items() if text and name.lower().startswith(REMARK)
            )
        modes = self.modes(row, values) or [None]
        channels = self._channels(values, naming)
        sensors = self._sensors(row, values, channels)
        event = self._name(row, values, "event")
        if len(modes) * len(channels) > 1:
            event = event or record
        # the sensors of one motion share its clamping: they are no repeats of each other
        hold = values.get("clamping") or values.get("hold") or event or record
        lines = []
        for mode in modes:
            self._in_band(row, common["band_Hz"], mode, common["load"])
            for channel, sensor in zip(channels, sensors, strict=True):
                name = record
                if len(modes) * len(channels) > 1:
                    name += f"-{mode}"
                if len(channels) > 1:
                    name += f"-{_id_of(channel)}"
                lines.append(
                    {"record": name, "row": record, "mode": mode, "channel": channel,
                     "sensor": sensor, "event": event, "hold": hold, **common}
                )  # fmt: skip
        return lines

    def _load(self, row: int, values: dict) -> dict:
        value = self.load_value(row, values)
        force = value if self.load is not None and self.load.is_force else None
        return {"load": value, "force_N": force}

    def _name(self, row: int, values: dict, column: str) -> str:
        name = values.get(column, "")
        if ";" in name:
            self.fault(f"{column} must be a name without ';', got {name!r}", row)
        return name

    def _channels(self, values: dict, naming: dict[str, bool]) -> list[str | None]:
        """The channels that a cell names: split by ; or |, or by blanks where no channel has that
        name as a whole; without it, those that campaign.yaml has of the row's sensors.
        """
        cell = values.get("channel", "")
        if not cell:
            declared = self._declared()
            named = values.get("sensor", "").replace(",", " ").split()
            known = [declared.get(name, {}).get("channel") for name in named]
            return [str(one) for one in known] if known and all(known) else [None]
        if re.search(r"[;|]", cell):
            return [part.strip() for part in re.split(r"[;|]", cell) if part.strip()]
        parts = cell.split()
        if len(parts) < 2:
            return [cell or None]
        if cell not in naming:
            declared = {str(one.get("channel", name)) for name, one in self._declared().items()}
            several = all(part.isdecimal() for part in parts) or set(parts) <= declared
            naming[cell] = several or not self._holds(values["file"], cell)
        return parts if naming[cell] else [cell]

    def _holds(self, file: str, channel: str) -> bool:
        """Whether a raw file has a channel of that name; what else is wrong with it, its job says.

        Asked of the first file only in which a name with blanks occurs.
        """
        try:
            read(self.folder / file, channel=channel)
        except ValueError as error:
            return "expected channel" not in str(error)
        return True

    def _declared(self) -> dict[str, dict]:
        return self.description.get("sensors", {})

    def _sensors(self, row: int, values: dict, channels: list[str | None]) -> list[str]:
        """The sensor of each channel: as the sheet says, as `sensors` has it, or the channel."""
        declared = self._declared()
        named = values.get("sensor", "").replace(",", " ").split()
        if named and len(named) != len(channels):
            self.fault(
                f"sensor must name one for each of the {len(channels)} channels, got "
                f"{values['sensor']!r}",
                row,
            )
            return [""] * len(channels)
        of_channel = {str(one.get("channel", name)): name for name, one in declared.items()}
        if not named:
            several = len(channels) > 1
            named = [of_channel.get(c or "", _id_of(c) if several else "") for c in channels]
        for name in named:
            if name and not is_id(name):
                self.fault(f"sensor must be {ID_RULE}, got {short(name)!r}", row)
            elif name and declared and name not in declared:
                given = "sensor" if values.get("sensor") else "channel"
                known = ", ".join(declared if given == "sensor" else of_channel)
                self.fault(
                    f"{given} must be one of {known} (campaign.yaml), got "
                    f"{values.get(given, name)!r}",
                    row,
                )
        return named

    def _window(self, row: int, values: dict) -> dict:
        """Part of the file, start, end and band that a person gives, or None."""
        start, end = self._times(row, values, "start_s", "end_s")
        text, band = values.get("band_Hz", ""), None
        if text:
            parts = re.fullmatch(r"\s*([\d.eE+]+)\s*(?:-|to|\s|;|:)\s*([\d.eE+]+)\s*", text)
            try:
                band = [float(parts[1]), float(parts[2])] if parts else None
            except ValueError:
                band = None
            if band is None or not 0.0 < band[0] < band[1]:
                self.fault(f"band_Hz must be two frequencies such as 60-100, got {text!r}", row)
        first, last = self._times(row, values, "from_s", "to_s")
        return {"from_s": first, "to_s": last, "start_s": start, "end_s": end, "band_Hz": band}

    def _in_band(
        self, row: int, band_Hz: list[float] | None, mode: str | None, load: float | None
    ) -> None:
        """A band holds the mode that it is for."""
        if band_Hz and mode:
            expected_Hz = expected_at(self.description["modes"][mode], self.load, load)
            if not band_Hz[0] < expected_Hz < band_Hz[1]:
                self.fault(
                    f"band_Hz must hold the {expected_Hz:g} Hz of {mode}, got {band_Hz[0]:g} to "
                    f"{band_Hz[1]:g}",
                    row,
                )

    def _times(self, row: int, values: dict, begin: str, end: str) -> list[float | None]:
        """Two optional times, the second after the first."""
        first, last = found = [self.optional_number(row, values, name) for name in (begin, end)]
        if first is not None and last is not None and last <= first:
            self.fault(f"{end} must lie after {begin}, got {last:g} and {first:g}", row)
        return found

    def _raw_file(self, row: int, record: str, name: str) -> str:
        if not name:
            self.fault("file is missing", row)
        elif "bench" in self.description:
            if name != f"{record}.nc":
                self.fault(f"file of a simulated record must be {record}.nc, got {name!r}", row)
        elif Path(name).suffix.lower() not in formats():
            self.fault(f"file must end in {', '.join(sorted(formats()))}, got {short(name)!r}", row)
        elif SPECIAL & set(name):
            self.fault(f"file must have none of {SPECIAL_TEXT} in its name, got {short(name)}", row)
        elif not is_there((self.folder / name).is_file):
            self.fault(f"file not found: {short(name)}", row)
        return name

    def _quantity(self, row: int, values: dict) -> dict:
        """Quantity, unit and sensitivity as far as the sheet gives them; the rest the file says."""
        quantity = self.choice(row, values, "quantity", tuple(SI), "") or None
        unit = values.get("unit") or None
        sensitivity = values.get("sensitivity") or None
        if unit:
            try:
                found = motion(unit, sensitivity)[0]
            except ValueError as error:
                self.fault(str(error), row)
            else:
                if quantity in SI and quantity != found:
                    fitting = [name for name, (of, _) in USUAL.items() if of == quantity]
                    self.fault(
                        f"unit of {quantity} must be one such as {', '.join(fitting)}, got "
                        f"{unit!r} of {found}",
                        row,
                    )
        elif sensitivity:
            try:
                sensitivity_of(sensitivity)
            except ValueError as error:
                self.fault(str(error), row)
        return {"quantity": quantity, "unit": unit, "sensitivity": sensitivity}

    def _response(self, row: int, values: dict) -> str | None:
        """The sensor's response."""
        text = values.get("response") or None
        try:
            if text:
                undoing(text)
        except ValueError as error:
            self.fault(str(error), row)
        return text

    def _one_use(self, rows: list[tuple[int, dict]]) -> None:
        """Warn of a raw file that stands for two records of one mode."""
        first_row: dict[tuple, int] = {}
        for row, values in rows:
            part = values.get("from_s", ""), values.get("to_s", "")
            where = values.get("channel", ""), values.get("sensor", "")
            place = (values["file"], *where, values["mode"], *part)
            if values["file"] and place in first_row:
                self.warn(f"file {values['file']} stands in row {first_row[place]} already", row)
            first_row.setdefault(place, row)

    def _events(self, rows: list[int], checked: list[dict]) -> None:
        """The rows of one event are one motion: what was done to the specimen is one, too."""
        first: dict[str, tuple[int, dict]] = {}
        for row, line in zip(rows, checked, strict=True):
            if not line["event"]:
                continue
            where, other = first.setdefault(line["event"], (row, line))
            for name in _EVENT_COLUMNS:
                if line[name] != other[name]:
                    self.fault(
                        f"event {line['event']!r} is one motion, but {name} is {line[name]!r} here "
                        f"and {other[name]!r} in row {where}",
                        row,
                    )
            rates = line["sampling_Hz"], other["sampling_Hz"]
            if None not in rates and rates[0] != rates[1]:
                self.fault(
                    f"event {line['event']!r} is one motion, but sampling_Hz is {rates[0]:g} here "
                    f"and {rates[1]:g} in row {where}",
                    row,
                )

    def _near_loads(self, rows: list[int], checked: list[dict]) -> None:
        """Warn where repeats are told apart by what a gauge read, for then they are not pooled."""
        if self.load is None:
            return
        name = "force" if self.load.is_force else self.load.name
        for mode in self.description["modes"]:
            first: dict[float, int] = {}
            for row, line in zip(rows, checked, strict=True):
                if line["mode"] == mode and not line["exclude"]:
                    first.setdefault(line["load"], row)
            loads = sorted(first)
            near = [a for a, b in pairwise(loads) if a > 0.0 and b - a < SAME_LOAD * b]
            if near:
                other = loads[loads.index(near[0]) + 1]
                self.warn(
                    f"{mode}: {len(near) + 1} {name}s lie less than 1 % apart, as {near[0]:g} and "
                    f"{other:g} {self.load.unit}: records are pooled, and their scatter is known, "
                    f"only where the {name} is the same; repeats of one {name} need its nominal "
                    "value",
                    first[near[0]],
                )


def _id_of(channel: str | None) -> str:
    """A channel's name as part of a record's id."""
    return _FOREIGN.sub("-", channel or "").strip("-")[:LONGEST_CHANNEL] or "channel"
