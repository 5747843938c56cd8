"""The parts of a report, and a page made of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources

import jinja2
from matplotlib.figure import Figure

from bladeroot.figures.chart import Chart
from bladeroot.figures.live import live
from bladeroot.figures.still import still
from bladeroot.figures.style import svg
from bladeroot.report.numbers import NONE

_LONGEST_NAME = 16  # characters of a cell that does not break at its hyphens
SHOWN_ROWS = 12  # of a long table that stand there at once; the others are asked for


@dataclass(frozen=True)
class Table:
    """A table of finished texts; a row's cells stand under the header's.

    A folded one shows its caption only, until it is opened; a long one its first rows.
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

    @property
    def is_long(self) -> bool:
        """Whether only its first rows are shown; a few more are no reason to hide them."""
        return not self.folded and len(self.rows) > 1.5 * SHOWN_ROWS

    def is_text(self, column: int) -> bool:
        """Whether a column holds words, which stand to the left; numbers stand to the right."""
        return column == 0 or any(row[column][:1].isalpha() for row in self.rows)

    def is_short(self, column: int) -> bool:
        """Whether no cell of a column is longer than a name, which must not break at its hyphen."""
        return all(len(row[column]) <= _LONGEST_NAME for row in self.rows)


class Link(str):
    """A text that leads to another page."""

    def __new__(cls, text: str, href: str) -> "Link":
        """The text, with the address beside it."""
        made = super().__new__(cls, text)
        made.href = href
        return made


@dataclass(frozen=True)
class Picture:
    """A figure as SVG text with its caption, and as what a script makes live (JSON)."""

    svg: str
    caption: str
    live: str = ""


def pictures(drawn: Chart | Figure | None, caption: str = "") -> list[Picture]:
    """A chart with its own caption, or a figure with this one; nothing where there is none."""
    if drawn is None:
        return []
    if isinstance(drawn, Figure):
        return [Picture(_inline(svg(drawn)), caption)]
    return [Picture(_inline(svg(still(drawn))), drawn.caption, live(drawn))]


def _inline(text: str) -> str:
    """The drawing without the file's XML head, to stand inside a page."""
    return text[text.index("<svg") :]


@dataclass(frozen=True)
class Box:
    """What must not be overlooked: a head and lines."""

    head: str
    lines: Sequence[str]


@dataclass(frozen=True)
class Cards:
    """The answer at a glance: of each card a head, a large text and lines below it."""

    cards: Sequence[tuple[str, str, Sequence[str]]]


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs (str), tables, pictures, boxes and cards in reading order."""

    title: str
    parts: Sequence["str | Table | Picture | Box | Cards"] = field(default_factory=list)


@dataclass(frozen=True)
class Place:
    """Where a page stands: the links to all pages (text, address, whether it is this one), and the
    way from it to the plotting library.
    """

    links: Sequence[tuple[str, str, bool]] = ()
    library: str = ""


def render(
    title: str,
    subtitle: str,
    simulated: bool,
    sections: Sequence[Section],
    footer: str,
    place: Place | None = None,
) -> str:
    """A whole HTML page, which needs no other file but the plotting library, and that only to
    make its figures live.
    """
    template, style, script = _look()
    return template.render(
        title=title,
        subtitle=subtitle,
        simulated=simulated,
        sections=sections,
        short=SHOWN_ROWS,
        footer=footer,
        place=place or Place(),
        has_live=any(isinstance(p, Picture) and p.live for s in sections for p in s.parts),
        style=style,
        script=script,
    )


@cache
def _look() -> tuple[jinja2.Template, str, str]:
    """The page's template, style and script."""
    files = resources.files(__package__)
    template, *others = (
        (files / name).read_text(encoding="utf-8")
        for name in ("page.html.j2", "page.css", "page.js")
    )
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    for kind in (Table, Picture, Box, Cards):
        environment.tests[kind.__name__.lower()] = lambda part, kind=kind: isinstance(part, kind)
    return (environment.from_string(template), *others)
