"""What a person overrules in a record, as the sheet says it: start, end, band and keep."""

from collections.abc import Mapping

NAMES = ("start_s", "end_s", "band_Hz", "keep")


def overruled(row: Mapping) -> str:
    """The overrides of a row of the sheet in words, with the remark that justifies them, or ""."""
    said = []
    for name in NAMES:
        value = row.get(name)
        if value is None or value is False:
            continue
        text = "-".join(f"{edge:g}" for edge in value) if name == "band_Hz" else ""
        said.append(f"{name} {text or ('yes' if value is True else f'{value:g}')}")
    if not said:
        return ""
    note = row.get("note", "")
    return ", ".join(said) + (f" ({note})" if note else ": no note says why")
