"""The section on where the source contradicts itself."""

from collections.abc import Sequence

from bladeroot.report.page import Section, Table


def errata_section(errata: Sequence[dict]) -> Section:
    """Each erratum with the arithmetic that shows it."""
    rows = [
        (entry["where"], entry["printed"], entry["probably"], entry["arithmetic"].strip())
        for entry in errata
    ]
    return Section(
        "Errata of the source",
        [
            "The thesis's tables are used as printed. Where they or an equation contradict "
            "themselves, the arithmetic says so here; nothing is corrected silently.",
            Table("Errata", ("where", "printed", "probably", "arithmetic"), rows),
        ],
    )
