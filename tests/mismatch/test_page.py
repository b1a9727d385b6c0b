"""The report page: what it says for every verdict, and that it stands on its own."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import explanations
import numpy as np
import pytest
from plotly.graph_objects import Figure as PlotlyFigure

from residuum.mismatch.report import wording
from residuum.mismatch.report.figures import CLOUD_POINTS, LINE_POINTS, thin_cloud, thin_line
from residuum.mismatch.report.page import VERDICTS, report
from residuum.mismatch.report.variables import readings
from residuum.mismatch.result import Region, Source
from residuum.symbolic.effects import EFFECTS

#: Bytes; more is no page to send to a colleague.
LARGEST = 6_000_000


class Page(HTMLParser):
    """Elements with their attributes, and the text outside of scripts and styles."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements, self.open, self.words = [], [], []
        self.feed(html)
        self.text = " ".join(" ".join(self.words).replace("\u202f", " ").split())

    def handle_starttag(self, tag, attrs) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in ("meta", "link", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data) -> None:
        if not {"script", "style"} & set(self.open):
            self.words.append(data)

    def named(self, tag) -> list[dict]:
        return [a for t, a in self.elements if t == tag]


@pytest.fixture(scope="module")
def pages():
    return {name: (make(), report(make())) for name, make in explanations.ALL.items()}


def data_of(html: str) -> dict:
    return json.loads(re.search(r'id="figure-data">(.*?)</script>', html, re.S)[1])


@pytest.mark.parametrize("name", explanations.ALL)
def test_page_is_whole_and_stands_alone(pages, name) -> None:
    explanation, html = pages[name]
    page = Page(html)
    assert not page.open
    assert len(html.encode()) < LARGEST
    assert explanation.sentence in page.text
    assert VERDICTS[explanation.findings["verdict"]][0] in page.text
    assert "src" not in {k for _, a in page.elements for k in a}
    assert all(a["href"].startswith("data:") for a in page.named("link"))
    assert not page.named("a")
    (policy,) = [a["content"] for a in page.named("meta") if a.get("http-equiv")]
    assert policy.startswith("default-src 'none'")


@pytest.mark.parametrize("name", explanations.ALL)
def test_headings_are_in_order_and_plots_have_words(pages, name) -> None:
    page = Page(pages[name][1])
    levels = [int(t[1]) for t, _ in page.elements if re.fullmatch(r"h\d", t)]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))
    plots = [a for a in page.named("div") if a.get("class") == "plot"]
    assert all(len(a["aria-label"]) > 20 for a in plots)
    assert {a["id"] for a in plots} == set(data_of(pages[name][1]))
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("name", explanations.ALL)
def test_plots_are_valid_and_thin(pages, name) -> None:
    for figure in data_of(pages[name][1]).values():
        for part in json.dumps(figure).split('"'):
            assert not part.startswith("--") or part[2:].isalpha()
        plain = json.loads(re.sub(r'"--[a-z]+"', '"#123456"', json.dumps(figure)))
        PlotlyFigure(plain)  # raises for properties that plotly does not have
        assert all(len(t["x"]) == len(t["y"]) <= LINE_POINTS for t in figure["data"])


def test_one_finding_is_told_in_full(pages) -> None:
    text = Page(pages["one_finding"][1]).text
    for part in (
        wording.capital(EFFECTS["load_dependent_friction"].title),
        "0.0712 ± 0.0021",
        "Joints 2 and 3, confidence 97 %",
        "joint 2: 83 %",
        "goes with the torque that the joint carries, by direction of motion, mostly from 18 to 34 Nm",
        "instead of 9.88 Nm",
        "gen-model --model model.toml",
        "reaches 96 % on joint 2 and 96 % on joint 3",
        explanations.SCHEME[1:],
        "cell3_healthy.csv",
    ):
        assert part in text
    assert "<math" in pages["one_finding"][1]


def test_two_findings_say_what_cannot_be_told_apart(pages) -> None:
    text = Page(pages["two_findings"][1]).text
    assert "1.503 ± 0.021 kg" in text and "(0.0010 ± 0.0020, −0.0120 ± 0.0020, 0.0510 ± 0.0040) m" in text
    assert (
        f"cannot tell it from: “{EFFECTS['link_inertial'].title}” or “{EFFECTS['base_tilt'].title}”" in text
    )
    assert "40 % of what is unexplained comes and goes, at 41.2–44.0 s in cell3_monday.csv." in text
    shapes = data_of(pages["two_findings"][1])["time-2"]["layout"]["shapes"]
    assert [(s["x0"], s["x1"]) for s in shapes] == [(41.2, 44.0)]


def test_unknown_shows_a_curve_that_is_called_no_physics(pages) -> None:
    html = pages["unknown"][1]
    names = [t["name"] for t in data_of(html)["region-4-q"]["data"]]
    assert names == ["unexplained", "flexible curve: not physics"]
    assert [t["name"] for t in data_of(html)["time-4"]["data"]] == ["model as it is"]
    assert "model.toml" not in Page(html).text


def test_nothing_missing_names_nothing(pages) -> None:
    page = Page(pages["nothing_missing"][1])
    assert "What was found" not in page.text and "After" not in page.text
    assert "How well the model does" in page.text


def test_bad_data_tells_what_is_wrong_first(pages) -> None:
    page = Page(pages["bad_data"][1])
    assert page.text.index("the angle of joint 3 is stuck. Where") > 0
    assert page.text.index("What is wrong") < page.text.index("actual_q_2 never changes")
    assert page.text.index("actual_q_2 never changes") < page.text.index("What was found")
    assert "How well" not in page.text
    assert data_of(pages["bad_data"][1]) == {}


def test_next_motion_is_listed(pages) -> None:
    page = Page(pages["with_next_motion"][1])
    assert "movej([0.5, -1.2" in page.text and "URScript, 42 lines" in page.text
    assert "28.6" in page.text and page.text.count("Reverse joint 2 over") == 1


def test_a_motion_that_does_not_exist_has_no_listing() -> None:
    plain = explanations.with_next_motion()
    none = replace(plain.next_motion, waypoints=np.empty((0, 6)), script="", text="None of 9 motions does.")
    text = Page(report(replace(plain, next_motion=none))).text
    assert "None of 9 motions does." in text and "URScript," not in text and "Waypoints" not in text


def test_a_fault_of_the_whole_recording_names_no_joint() -> None:
    plain = explanations.bad_data()
    fault = {**plain.findings["findings"][0], "joints": []}
    text = Page(report(replace(plain, findings={**plain.findings, "findings": [fault]}))).text
    assert "The whole recording, confidence" in text and "no joint" not in text


def test_what_comes_from_files_is_no_markup() -> None:
    evil = "</script><script>alert(1)</script>"
    plain = explanations.one_finding()
    found = {**plain.findings["findings"][0], "equation": rf"\undefined{{{evil}"}
    findings = {**plain.findings, "findings": [found]}
    traces = tuple(replace(t, recording=evil) for t in plain.traces)
    sources = (Source(evil, 1.0, 1.0, False, (evil,)),)
    html = report(replace(plain, sentence=evil, findings=findings, traces=traces, sources=sources))
    assert evil not in html
    assert not Page(html).open


def test_every_effect_has_a_page_without_leftover_latex() -> None:
    for effect in EFFECTS.values():
        blocks = wording.mathml(effect.equation)
        assert blocks and all(b.startswith("<math") for b in blocks), effect.name
        assert "\\" not in "".join(blocks), effect.name


def test_equations_side_by_side_become_lines() -> None:
    assert len(wording.mathml(r"a \left(x\right),\ y \leftarrow f\left(a,\ b\right)")) == 2
    assert wording.mathml(r"\frac{") == ["<code>\\frac{</code>"]


def test_thinning_keeps_extremes() -> None:
    y = np.random.default_rng(3).normal(size=100_000)
    y[777], y[5000] = 50.0, np.nan
    line = thin_line(y)
    assert len(line) <= LINE_POINTS and 777 in line and np.nanargmin(y) in line and 5000 not in line
    assert (np.diff(line) > 0).all()
    x = np.linspace(0, 1, len(y))
    cloud = thin_cloud(x, y)
    assert len(cloud) <= CLOUD_POINTS and {0, 777, len(y) - 1} <= set(cloud.tolist())
    assert len(thin_line(np.full(9, np.nan))) == 0 == len(thin_cloud(x[:9], np.full(9, np.nan)))


def test_torque_along_the_motion_turns_with_it() -> None:
    trace = explanations.trace(2, "load_dependent_friction")
    found = readings(trace, "load sign")
    assert (found.effect > -1e-9).all() and len(found.x) < len(trace.time)
    assert readings(trace, "t") is None and readings(trace, "motor") is None


def test_regions_without_a_plot_are_said_in_words() -> None:
    plain = explanations.one_finding()
    regions = (*plain.regions, Region(5, "motor", 0.31, 0.0, 1.0, "rad"))
    text = Page(report(replace(plain, regions=regions))).text
    assert (
        "Joint 5: 31 % of what is unexplained goes with the angle of the motor within its turn, mostly from 0 to 1 rad."
        in text
    )


@pytest.mark.parametrize(
    ("value", "std", "unit", "text"),
    [
        (1.5034, 0.0213, "kg", "1.503 ± 0.021 kg"),
        (12.0, 3.0, "Nm s/rad", "12.0 ± 3.0 Nm s/rad"),
        (3.2e-6, 1e-7, "kg m^2", "(3.20 ± 0.10) × 10⁻⁶ kg m²"),
        (-0.5, None, "1", "−0.500"),
        (0.1, 0.01, "rad", "0.100 ± 0.010 rad (5.7°)"),
        (1234.0, 250.0, "N", "1234 ± 250 N"),
    ],
)
def test_numbers_have_as_many_digits_as_their_error(value, std, unit, text) -> None:
    assert wording.with_error(value, std, unit).replace("\u202f", " ") == text


def test_words() -> None:
    assert wording.joints_text([3, 2]) == "joints 2 and 3"
    assert wording.joints_text([1, 2, 3], 3) == "all joints"
    assert wording.parameter_name("load_dependent_friction", "mu_2").endswith(" mu, joint 2")
    assert wording.percent(0.997).startswith("over 99") and wording.percent(float("nan")) == "–"
    assert wording.intervals_text([(k, k + 1) for k in range(9)]).endswith("and 3 more")
