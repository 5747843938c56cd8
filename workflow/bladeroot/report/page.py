"""The parts of a report, and the page made of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import resources

import jinja2

from bladeroot.report.numbers import NONE

_NAME = 16  # characters


@dataclass(frozen=True)
class Table:
    """A table of finished texts; a row's cells stand under the header's.

    A folded one shows its caption only, until it is opened.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    folded: bool = False

    def __post_init__(self) -> None:
        """Drop the columns that hold nothing but dashes."""
        full = [i for i in range(len(self.header)) if any(row[i] != NONE for row in self.rows)]
        object.__setattr__(self, "header", [self.header[i] for i in full])
        object.__setattr__(self, "rows", [[row[i] for i in full] for row in self.rows])

    def is_text(self, column: int) -> bool:
        """Whether a column holds words, which stand to the left; numbers stand to the right."""
        return column == 0 or any(row[column][:1].isalpha() for row in self.rows)

    def is_short(self, column: int) -> bool:
        """Whether no cell of a column is longer than a name, which must not break at its hyphen."""
        return all(len(row[column]) <= _NAME for row in self.rows)


@dataclass(frozen=True)
class Picture:
    """A figure as SVG text with its caption."""

    svg: str
    caption: str


@dataclass(frozen=True)
class Box:
    """What must not be overlooked: a head and lines."""

    head: str
    lines: Sequence[str]


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs (str), tables, pictures and boxes in reading order."""

    title: str
    parts: Sequence["str | Table | Picture | Box"] = field(default_factory=list)


def render(
    title: str, subtitle: str, simulated: bool, sections: Sequence[Section], footer: str
) -> str:
    """The whole self-contained HTML page."""
    files = resources.files(__package__)
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    environment.tests["table"] = lambda part: isinstance(part, Table)
    environment.tests["picture"] = lambda part: isinstance(part, Picture)
    environment.tests["box"] = lambda part: isinstance(part, Box)
    template = environment.from_string((files / "page.html.j2").read_text(encoding="utf-8"))
    return template.render(
        title=title,
        subtitle=subtitle,
        simulated=simulated,
        sections=sections,
        footer=footer,
        style=(files / "page.css").read_text(encoding="utf-8"),
    )
