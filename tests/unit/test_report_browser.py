"""A page in a browser: hovering, switching, narrow screens, print, and no script at all."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.report.contents import LIBRARY
from bladeroot.report.page import Cards, Place, Section, Table, pictures, render

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
plotly = pytest.importorskip("plotly", reason="plotly is not installed")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not CHROMIUM, reason="no chromium here"),
]


def chart():
    x = np.geomspace(0.1, 10.0, 9)
    one = Trace(0, x, 500.0 - x, "r1", "#1b3a5c", "-", "o", error=np.full(9, 0.25),
                switches={"load": "4 kN", "record": "r1"})  # fmt: skip
    return Chart(
        "Frequency over amplitude.",
        [Panel("mode 1B", "amplitude / µm", "frequency / Hz", x_log=True),
         Panel("mode 2B", "amplitude / µm", "loss factor / %")],
        [one, replace(one, name="r2", colour="#b5462f", y=one.y - 5.0,
                      switches={"load": "8 kN", "record": "r2"}), replace(one, panel=1)],
        colours="load",
    )  # fmt: skip


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    package = Path(plotly.__file__).parent / "package_data"
    shutil.copy(package / LIBRARY, folder / LIBRARY)
    wide = Table("Wide", [f"column {k}" for k in range(20)], [["a" * 15] * 20] * 30)
    parts = [Cards([("mode", "500 Hz", ["loss factor"])]), *pictures(chart()), wide]
    links = [(name, f"{name}.html", False) for name in ("Measurement", "Comparison", "Theory")]
    text = render("A joint", "s", True, [Section("One", parts)], "f" * 300, Place(links, LIBRARY))
    (folder / "page.html").write_text(text)
    return (folder / "page.html").as_uri()


@pytest.fixture(scope="module")
def browser():
    with sync.sync_playwright() as playwright:
        made = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
        )
        yield made
        made.close()


@pytest.fixture
def opened(browser, page_file):
    """A function that opens the page at a width, with or without scripts, once it is drawn."""
    shown = []

    def show(width=1280, script=True):
        context = browser.new_context(
            viewport={"width": width, "height": 800}, java_script_enabled=script
        )
        page = context.new_page()
        page.faults = []
        page.on("pageerror", lambda fault: page.faults.append(str(fault)))
        page.goto(page_file)
        if script:
            page.wait_for_selector("figure.made-live", timeout=60_000)
        shown.append(context)
        return page

    yield show
    for context in shown:
        context.close()


def traces(page):
    return page.locator(".live .scatterlayer .trace").count()


def test_the_pointer_reads_a_value_with_its_error(opened):
    page = opened()
    page.locator(".live .scatterlayer .point").nth(4).hover(force=True)
    text = page.locator(".live .hoverlayer").text_content(timeout=20_000)
    assert "r1" in text
    assert "frequency / Hz: 499" in text
    assert "± 0.25" in text
    assert page.faults == []


def test_loads_and_records_are_switched_and_axes_made_linear(opened):
    page = opened()
    assert traces(page) == 3
    page.get_by_label("4 kN").uncheck()
    page.wait_for_function("document.querySelectorAll('.scatterlayer .trace').length === 1")
    page.get_by_label("4 kN").check()
    page.get_by_label("r2").uncheck()
    page.wait_for_function("document.querySelectorAll('.scatterlayer .trace').length === 2")
    scale = "document.querySelector('.live')._fullLayout.xaxis.type"
    before = page.evaluate(scale)
    for _ in range(2):
        page.get_by_role("button", name="log x").click()
    assert (before, page.evaluate(scale)) == ("log", "linear")


@pytest.mark.parametrize("width", [390, 1280])
def test_nothing_is_wider_than_the_page(opened, width):
    page = opened(width)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    beyond = "e => e.filter(x => x.getBoundingClientRect().right > innerWidth + 1).length"
    assert page.locator("figure, .card, nav a, p, .scroll, .live, .bar").evaluate_all(beyond) == 0


def test_long_tables_are_short_until_they_are_asked_for(opened):
    page = opened()
    rows = page.locator("figure.table tbody tr:visible")
    first = rows.count()
    page.get_by_text("All 30 rows").click()
    assert (first, rows.count()) == (12, 30)


def test_print_and_no_script_have_the_still_picture(opened):
    page = opened(script=False)
    assert page.locator(".still svg").is_visible()
    page = opened()
    assert not page.locator(".still svg").is_visible()
    page.emulate_media(media="print")
    assert page.locator(".still svg").is_visible()
    assert not page.locator(".live").is_visible()
