"""The report page in a real browser: it draws, complains of nothing, and asks nobody for anything."""

from dataclasses import replace

import browser
import explanations
import pytest

from residuum.mismatch.report.page import report

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(browser.CHROMIUM is None, reason="no Chromium here: apt-get install chromium"),
]
SIZES = {"desk": (1280, 800), "phone": (360, 740)}
#: Plots that are shown at once; the folded ones are drawn when they are opened.
PLOTS = {
    "one_finding": 6,
    "two_findings": 6,
    "unknown": 3,
    "nothing_missing": 1,
    "bad_data": 0,
    "with_next_motion": 4,
}


@pytest.fixture(scope="module")
def tab():
    with browser.chromium() as found:
        yield found


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    for name, make in explanations.ALL.items():
        (folder / f"{name}.html").write_text(report(make()), encoding="utf-8")
    return {name: folder / f"{name}.html" for name in explanations.ALL}


@pytest.fixture
def quiet(tab):
    """The tab, whose page must ask for no file but itself and complain of nothing."""
    tab.errors.clear()
    tab.requests.clear()
    yield tab
    assert tab.errors == []
    assert tab.requests and all(r.startswith("file:") for r in tab.requests)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", explanations.ALL)
def test_page_draws_and_fits(quiet, files, name, size) -> None:
    width, height = SIZES[size]
    quiet.open(files[name], width, height)
    drawn = quiet.run(
        "[...document.querySelectorAll('.plot')].filter(p => p.querySelector('.scatterlayer path,"
        " .scatterlayer .point, .barlayer path')).length"
    )
    assert drawn == PLOTS[name]
    assert quiet.run("document.documentElement.scrollWidth") <= width
    bottom = quiet.run("document.querySelector('h1').getBoundingClientRect().bottom")
    assert 0 < bottom < height
    wide = "[...document.querySelectorAll('.main-svg')].map(s => s.getBoundingClientRect().right)"
    assert max(quiet.run(wide), default=0) <= width


def test_a_long_sentence_stays_on_the_first_screen(quiet, tmp_path) -> None:
    plain = explanations.two_findings()
    page = tmp_path / "long.html"
    page.write_text(report(replace(plain, sentence=" ".join([plain.sentence] * 4))), encoding="utf-8")
    quiet.open(page, *SIZES["phone"])
    assert quiet.run("document.querySelector('h1').getBoundingClientRect().bottom") < SIZES["phone"][1]


def test_folded_plots_are_drawn_when_opened(quiet, files) -> None:
    quiet.open(files["one_finding"], *SIZES["desk"])
    quiet.run("document.querySelector('#where details').open = true; 1")
    quiet.wait("document.querySelectorAll('#where details .scatterlayer .js-line').length === 8")


def test_colours_follow_the_scheme(quiet, files) -> None:
    stroke = "getComputedStyle(document.querySelectorAll('#time-2 .js-line')[1]).stroke"
    quiet.open(files["one_finding"], *SIZES["desk"])
    light = quiet.run(stroke)
    quiet.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    quiet.wait(f"{stroke} !== '{light}'")
    quiet.call("Emulation.setEmulatedMedia", features=[])
    quiet.wait(f"{stroke} === '{light}'")


def test_page_prints(quiet, files) -> None:
    quiet.open(files["one_finding"], *SIZES["desk"])
    pdf = quiet.call("Page.printToPDF", preferCSSPageSize=True, transferMode="ReturnAsBase64")["data"]
    assert len(pdf) > 100_000
    assert quiet.run("document.body.classList.contains('on-paper')") is False
