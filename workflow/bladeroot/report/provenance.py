"""Where a report comes from: version, date, settings, hashes of source files, how to repeat it."""

from collections.abc import Mapping

from bladeroot.report.page import Section, Table


def provenance_section(made: Mapping) -> Section:
    """made: version, environment, date, settings (by stage, JSON texts), sources (sha256 by path)
    and command, as `report/provenance.json` has them.
    """
    return Section(
        "Where this comes from",
        [
            f"bladeroot {made['version']}, {made['date']}; {made['environment']}. Again: "
            f"{made['command']}",
            Table("Settings of each stage", ("stage", "settings"),
                  list(made["settings"].items()), folded=True),
            Table(f"Source files ({len(made['sources'])})", ("file", "sha256"),
                  list(made["sources"].items()), folded=True),
        ],
    )  # fmt: skip
