"""Pages of the plant and its loops, and the JSON of both, without a server."""

import asyncio
import json
import re
from dataclasses import replace
from datetime import timedelta
from html.parser import HTMLParser
from types import SimpleNamespace
from urllib.parse import quote

import httpx
import pytest

from lostmotion.printable import printable
from lostmotion.store.encoded import clean
from lostmotion.store.rows import AssessmentRow
from lostmotion.store.run_rows import LoopRow, RunRow
from lostmotion.store.store import Screened, Store
from lostmotion.web.app import create_app
from lostmotion.web.page import Page
from lostmotion.web.plant.query import PARTS, Query, loop_address
from tests.support.plant_rows import END, HOSTILE, START, finding, plant, sound
from tests.support.plant_stores import TAGS, plant_store


class Site:
    """An application, asked one request after the other."""

    def __init__(self, page):
        self.app = create_app(page)

    def ask(self, path, method="GET", **how):
        async def asked():
            transport = httpx.ASGITransport(app=self.app, raise_app_exceptions=False)
            async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
                return await client.request(method, path, **how)

        return asyncio.run(asked())

    def text(self, path):
        answer = self.ask(path)
        assert answer.status_code == 200, answer.text
        return answer.text


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return Site(Page(plant_store(tmp_path_factory.mktemp("store"), data=False)))


def ranked(text):
    """Tags of the ranking, in their order."""
    table = text[text.index('class="ranking') : text.index("</table>", text.index('class="ranking'))]
    return re.findall(r'<th scope="row"[^>]*><a href="[^"]*"><bdi>(.*?)</bdi>', table)


def test_the_plant_page_says_what_needs_a_hand_first(site):
    text = site.text("/")
    assert ranked(text) == ["FIC-1", "FIC-3", "FIC-2", "FIC-4", "FIC-5"]
    assert "2 of 5 loops could be judged" in text
    assert "new finding" in text
    assert "Group 1: 2 loops" in text
    assert "notes.txt" in text
    assert text.count("<svg") > 5


@pytest.mark.parametrize(
    ("words", "tags"),
    [
        ("?text=fic-2", ["FIC-2"]),
        ("?verdict=stiction", ["FIC-1"]),
        ("?verdict=not+assessed", ["FIC-4"]),
        ("?verdict=failed", ["FIC-5"]),
        ("?label=(no+label)", ["FIC-3", "FIC-4", "FIC-5"]),
        ("?area=Unit+FIC-3", ["FIC-3"]),
        ("?type=flow&per=2&page=2", ["FIC-2", "FIC-4"]),
        ("?per=2&page=99", ["FIC-5"]),
        ("?sort=tag&turned=1", ["FIC-5", "FIC-4", "FIC-3", "FIC-2", "FIC-1"]),
        ("?new=1", ["FIC-1"]),
        ("?review=new", ["FIC-1", "FIC-3", "FIC-2", "FIC-4", "FIC-5"]),
        ("?run=1", ["FIC-1", "FIC-2"]),
        ("?sort=nonsense&page=-3&per=x", ["FIC-1", "FIC-3", "FIC-2", "FIC-4", "FIC-5"]),
    ],
)
def test_the_whole_state_stands_in_the_address(site, words, tags):
    assert ranked(site.text(f"/{words}")) == tags


def test_nothing_that_fits_leads_back_to_all(site):
    text = site.text("/?text=nothing+like+it&run=2")
    assert "No loop fits" in text
    assert 'href="/?run=2#ranking"' in text


def test_links_keep_the_state_and_begin_at_the_first_page(site):
    text = site.text("/?area=Unit+FIC-1&page=1")
    assert 'href="/?area=Unit+FIC-1&amp;sort=size"' in text
    assert "/loops/FIC-1?area=Unit+FIC-1" in text
    assert 'href="/?area=Unit+FIC-1#ranking"' in site.text("/loops/FIC-1?area=Unit+FIC-1")


def test_the_order_of_a_column_is_told_and_turned(site):
    assert 'aria-sort="descending"><a href="/?sort=size&amp;turned=1"' in site.text("/?sort=size")
    assert 'aria-sort="descending"><a href="/?turned=1"' in site.text("/")


@pytest.mark.parametrize("what", ["groups", "new", "data"])
def test_lists_of_a_run(site, what):
    assert "FIC-1" in site.text(f"/plant/{what}") or what == "data"
    assert site.ask("/plant/else").status_code == 404


def test_the_page_of_a_loop_has_verdict_evidence_and_downloads(site):
    text = site.text("/loops/FIC-1")
    for part in ("Stiction, 3.00 % of span", "Evidence", "Size over the runs", "Repack the valve.", 'id="review"'):
        assert part in text
    report = site.ask("/loops/FIC-1/report.html?run=2")
    assert report.headers["content-disposition"] == 'attachment; filename="FIC-1.html"'
    assert "http" not in report.text.replace("http://www.w3.org", "")
    assert "could be judged" not in text
    assert site.ask("/loops/FIC-9").status_code == 404
    assert site.ask("/loops/FIC-3?run=1").status_code == 404


def test_a_review_is_put_down_and_shown(tmp_path):
    site = Site(Page(plant_store(tmp_path, data=False)))
    said = {"state": "work order", "who": "Ada <b>", "note": "4711"}
    answer = site.ask("/loops/FIC-1/review?run=2", "POST", data=said)
    assert (answer.status_code, answer.headers["location"]) == (303, "/loops/FIC-1?run=2#review")
    text = site.text("/loops/FIC-1")
    assert "Ada &lt;b&gt;" in text
    assert "<b>" not in text.replace("<bdi>", "")
    assert ranked(site.text("/?review=work+order")) == ["FIC-1"]
    assert "FIC-1" not in ranked(site.text("/?review=new"))
    assert "work order" in site.text("/")


@pytest.mark.parametrize(
    "given",
    [
        {"state": "nonsense", "who": "Ada"},
        {"state": "accepted", "who": " "},
        {"state": "accepted", "who": "A" * 101},
        {"state": "accepted", "who": "Ada", "note": "n" * 20000},
        {},
    ],
)
def test_a_review_that_says_nothing_is_refused(site, given):
    answer = site.ask("/loops/FIC-1/review", "POST", data=given)
    assert answer.status_code == 400
    assert "expected" in answer.text
    assert site.ask("/loops/nix/review", "POST", data={"state": "accepted", "who": "Ada"}).status_code == 400


def test_json_has_the_names_of_the_rows(site):
    found = site.ask("/api/v1/loops?per=2").json()
    assert (found["run"], found["total"], found["next"]) == (2, 5, "/api/v1/loops?page=2&per=2")
    first = found["loops"][0]
    assert (first["tag"], first["loop_type"], first["assessment"]["size_percent"]) == ("FIC-1", "flow", 3.0)
    assert site.ask(site.ask("/api/v1/loops?per=4").json()["next"]).json()["next"] is None
    loop = site.ask("/api/v1/loops/FIC-1").json()
    assert loop["model"]["actuator"]["kind"] == "stiction"
    assert [one["run"] for one in loop["history"]] == [1, 2]
    third = site.ask("/api/v1/loops/FIC-3").json()["assessment"]
    assert third["excluded_percent"] is None, "infinity is no JSON"
    assert [one["number"] for one in site.ask("/api/v1/runs").json()["runs"]] == [2, 1]
    assert site.ask("/api/v1/groups").json()["groups"][0]["members"][0][0] == "FIC-1"
    assert site.ask("/api/v1/health").json()["cannot_tell"] == 1
    assert site.ask("/api/v1/counts?run=1").json()["verdict"] == {"none": 2}
    assert site.ask("/api/v1/news").json()["news"][0]["what"] == "new finding"


def test_json_of_reviews(tmp_path):
    site = Site(Page(plant_store(tmp_path, data=False)))
    given = {"tag": "FIC-2", "state": "rejected", "who": "Ada"}
    answer = site.ask("/api/v1/reviews", "POST", content=json.dumps(given))
    assert answer.status_code == 201
    assert answer.json()["reviews"][0]["who"] == "Ada"
    assert site.ask("/api/v1/reviews?tag=FIC-2").json()["reviews"][0]["state"] == "rejected"


@pytest.mark.parametrize("body", [b"", b"[]", b"\xff", b"[" * 10_000, b'{"tag": 1}', b"x" * 20_000])
def test_json_that_is_none_is_an_error_as_json(site, body):
    answer = site.ask("/api/v1/reviews", "POST", content=body)
    assert answer.status_code == 400
    assert "message" in answer.json()


@pytest.mark.parametrize(
    "path", ["/api/v1/nix", "/api/v1/loops/nix", "/api/v1/loops?run=99", "/api/v1/loops/FIC-3?run=1"]
)
def test_errors_of_the_interface_are_json(site, path):
    answer = site.ask(path)
    assert answer.status_code == 404
    assert set(answer.json()) == {"error", "message"}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("tag", ["a/b", "..", "a//b", "./x", "50 % ?#&", "µ/é", *HOSTILE])
def test_any_tag_has_a_page(tmp_path, tag):
    view = plant((tag, *TAGS[1:]))
    site = Site(
        Page(plant_store(tmp_path, (tag, *TAGS[1:]), replace(view, rows=(finding(tag), *view.rows[:2])), data=False))
    )
    for path in (loop_address(tag), loop_address(tag, "?run=2"), "/", "/plant/groups"):
        text = site.text(path)
        page = Tags()
        page.feed(text)
        assert page.scripts <= {"/static/page.js", "/static/trend.js", "/static/vendor/uPlot.iife.min.js"}
        assert not page.handlers
    assert site.ask("/api/v1" + loop_address(tag)).json()["loop"]["tag"] == tag
    answer = site.ask(loop_address(tag, part="review"), "POST", data={"state": "accepted", "who": "Ada"})
    assert answer.status_code == 303


@pytest.mark.parametrize("part", PARTS)
def test_no_tag_is_the_address_of_a_part_of_another_loop(tmp_path, part):
    """Tag "A/report.html" beside "A": each has its page, its report, its reviews and its JSON."""
    tags = ("A", f"A/{part}", part, "B", "C")
    view = plant(tags)
    site = Site(Page(plant_store(tmp_path, tags, replace(view, rows=tuple(map(finding, tags))), data=False)))
    for number, tag in enumerate(tags):
        assert f"<bdi>{tag}</bdi>" in site.text(loop_address(tag))
        assert site.ask("/api/v1" + loop_address(tag)).json()["loop"]["tag"] == tag
        report = site.ask(loop_address(tag, part="report.html"))
        assert report.headers["content-disposition"].startswith("attachment")
        assert f">{tag}<" in report.text
        said = {"state": "accepted", "who": f"who{number}"}
        assert site.ask(loop_address(tag, part="review"), "POST", data=said).status_code == 303
    for number, tag in enumerate(tags):
        reviews = site.ask(f"/api/v1/reviews?tag={quote(tag, safe='')}").json()["reviews"]
        assert [one["who"] for one in reviews] == [f"who{number}"]


@pytest.mark.parametrize("odd", ["\u202e", "\x1b[31m", "\x07", "\u2066", "\u061c", "\x85", "\udc80"])
def test_what_steers_is_written_out_on_pages_and_in_reports(tmp_path, odd):
    """Notes, names, tags, areas: one rule of all templates."""
    tag = f"FIC{odd}101"
    view = plant((tag, *TAGS[1:]))
    rows = (finding(tag), *view.rows[:2])
    site = Site(Page(plant_store(tmp_path, (tag, *TAGS[1:]), replace(view, rows=rows), data=False)))
    kept = clean(odd)
    given = {"state": "accepted", "who": f"A{odd}da", "note": f"valve {odd}deppots"}
    given = {name: text.encode("utf-8", "replace").decode() for name, text in given.items()}
    assert site.ask(loop_address(clean(tag), part="review"), "POST", data=given).status_code == 303
    for path in (loop_address(clean(tag)), loop_address(clean(tag), part="report.html"), "/", "/plant/groups"):
        text = site.text(path)
        assert kept not in text.replace(f'value="Unit {clean(tag)}"', "") or kept.isprintable()
        if odd != "\udc80" and path.endswith("101"):
            assert printable(" ".join(given["note"].split())) in text
    assert site.ask("/?area=" + quote(f"Unit {clean(tag)}")).status_code == 200


@pytest.mark.parametrize("name", ["who", "note"])
def test_a_review_with_nul_is_refused(site, name):
    given = {"state": "accepted", "who": "Ada", "note": "seen", name: "a\0b"}
    for path in ("/loops/FIC-1/review", "/api/v1/reviews"):
        how = {"data": given} if path.startswith("/loops") else {"json": {**given, "tag": "FIC-1"}}
        assert site.ask(path, "POST", **how).status_code == 400
    assert site.ask("/api/v1/reviews?tag=FIC-1").json()["reviews"] == []


class Tags(HTMLParser):
    """What of a page a browser would run: there must be nothing but the page's own scripts."""

    def __init__(self):
        super().__init__()
        self.scripts, self.handlers = set(), []

    def handle_starttag(self, tag, attrs):
        names = dict(attrs)
        if tag == "script":
            self.scripts.add(names.get("src"))
        self.handlers += [name for name in names if name.startswith("on") or name == "style"]
        if tag in ("style", "iframe", "object", "embed", "base"):
            self.handlers.append(tag)


def test_a_store_without_runs_says_how_to_make_one(tmp_path):
    with Store(tmp_path / "empty.db"):
        pass
    site = Site(Page(str(tmp_path / "empty.db")))
    assert "lostmotion audit" in site.ask("/").text
    assert site.ask("/api/v1/loops").status_code == 404


def test_words_of_an_address_are_read_back():
    asked = Query(run=3, text="a&b", area="ä/ö", new=True, sort="size", turned=True, page=4, per=10)
    words = dict(httpx.QueryParams(asked.words()[1:]))
    assert Query.of(words) == asked


def test_of_several_windows_the_one_that_says_most_is_shown(tmp_path):
    address = plant_store(tmp_path, data=False)
    day = timedelta(days=1)
    later = [
        finding("FIC-1", 10.0, window_start=START + day, window_end=END + day),
        finding("FIC-2", 90.0, window_start=START - day, window_end=START),
        sound("FIC-2"),
    ]
    with Store(address) as store:
        run, _ = store.begin(RunRow("plant", digest="d3", code="c", began=START))
        store.put_loops(run, [LoopRow("FIC-1"), LoopRow("FIC-2")])
        store.put_screened(run, [Screened((finding("FIC-1"), later[0])), Screened(tuple(later[1:]))])
        store.finish(run)
    site = Site(Page(address))
    assert ranked(site.text("/")) == ["FIC-2", "FIC-1"]
    first, second = site.ask("/api/v1/loops").json()["loops"]
    assert first["assessment"]["window_start"] == (START - day).isoformat()
    assert second["assessment"]["priority"] == 60.0
    assert "Windows of this run" in site.text("/loops/FIC-2")


def test_loops_that_a_rule_decides_are_counted_and_chosen_by_it(tmp_path):
    """By what the rule says, and as sure as it is; what was only screened too."""
    address = plant_store(tmp_path, data=False)
    rows = (
        finding("FIC-1", 35.0, verdict="saturation", size_percent=None, rule="frozen measurement"),
        sound("FIC-2", verdict="saturation", kind="actuator", priority=3.0, confidence=0.6),
        AssessmentRow("FIC-3", START, END, priority=20.0, rule="ringing", reason="a master"),
    )
    with Store(address) as store:
        run, _ = store.begin(RunRow("plant", digest="d3", code="c", began=START))
        store.put_loops(run, [LoopRow(row.tag) for row in rows])
        store.put_screened(run, [Screened((row,)) for row in rows])
        store.finish(run)
    site = Site(Page(address))
    assert site.ask("/api/v1/counts").json()["verdict"] == {"frozen measurement": 1, "saturation": 1, "ringing": 1}
    found = re.search("Findings: (.*?)[.]", site.text("/"))[1].split(", ")
    assert sorted(found) == ["1 loop to retune", "1 sensor to look at", "1 valve at its limits"]
    assert ranked(site.text("/?verdict=saturation")) == ["FIC-2"]
    assert ranked(site.text("/?verdict=frozen+measurement")) == ["FIC-1"]
    assert ranked(site.text("/?sort=sure")) == ["FIC-1", "FIC-3", "FIC-2"]
    health = site.ask("/api/v1/health").json()
    assert (health["judged"], health["by_rule"], health["screened"]) == (3, 2, 0)


class Desk:
    """Takes what is opened."""

    def __init__(self):
        self.opened = []

    def open(self, files, label, asked):
        self.opened.append((files, label, asked))
        return SimpleNamespace(id="17")


def test_the_study_of_a_loop_reads_its_data_at_the_desk(tmp_path):
    desk, address = Desk(), plant_store(tmp_path)
    site = Site(Page(address, desk))
    answer = site.ask("/loops/FIC-1/study", "POST")
    assert (answer.status_code, answer.headers["location"]) == (303, "/files/17")
    assert desk.opened == [([str(tmp_path / "plant" / "record.csv")], "FIC-1", {})]
    (tmp_path / "plant" / "record.csv").unlink()
    gone = site.ask("/loops/FIC-1/study", "POST")
    assert (gone.status_code, "not here" in gone.text) == (409, True)
    assert site.ask("/loops/nix/study", "POST").status_code == 404
    assert Site(Page(address)).ask("/loops/FIC-1/study", "POST").status_code == 409
