"""Answers that are kept: nobody is shown what is not true any more, and nothing grows for ever."""

from datetime import timedelta

import pytest

from lostmotion.store.run_rows import ReviewState, RunRow
from lostmotion.store.store import Screened, Store
from lostmotion.web.page import Page
from lostmotion.web.plant.kept import Kept
from lostmotion.web.plant.overview import Overview
from tests.support.plant_rows import START, finding
from tests.support.plant_stores import plant_store
from tests.unit.web.test_plant import Site, ranked

PATHS = ("/", "/?review=accepted", "/loops/FIC-1", "/api/v1/loops?review=accepted", "/api/v1/loops/FIC-1",
         "/api/v1/reviews?tag=FIC-1")  # fmt: skip


@pytest.fixture
def address(tmp_path):
    return plant_store(tmp_path, data=False)


@pytest.fixture
def site(address):
    return Site(Page(address))


@pytest.fixture
def drawn(monkeypatch):
    """How often a page of the ranking was made."""
    count = []
    shown = Overview.shown
    monkeypatch.setattr(
        Overview, "shown", lambda self, query, brief=False: count.append(query) or shown(self, query, brief)
    )
    return count


def test_the_same_question_is_answered_once(site, drawn):
    texts = {site.text("/?sort=tag") for _ in range(3)}
    assert (len(texts), len(drawn)) == (1, 1)
    assert site.text("/?sort=tag&turned=1") not in texts


@pytest.mark.parametrize("path", PATHS)
def test_a_review_of_anybody_is_seen_by_the_next_question_of_everybody(site, address, path):
    before = site.text(path)
    assert site.text(path) == before
    site.ask("/loops/FIC-1/review", "POST", data={"state": "accepted", "who": "Ada", "note": "seen on site"})
    here = site.text(path)
    assert here != before
    assert "accepted" in here
    with Store(address) as another_process:
        another_process.review("FIC-1", ReviewState.REPAIRED, "Grace", "")
    assert site.text(path) != here


def test_a_new_run_is_seen_at_once(site, address):
    assert ranked(site.text("/"))[0] == "FIC-1"
    with Store(address) as store:
        run, _ = store.begin(RunRow("plant", digest="d3", code="0.1.0", began=START + timedelta(days=30)))
        store.put_loops(run, [store.loop("FIC-2")])
        store.put_screened(run, [Screened((finding("FIC-2"),))])
        assert "Run 2" in site.text("/"), "the last finished one"
        store.finish(run)
    assert "Run 3" in site.text("/")
    assert ranked(site.text("/")) == ["FIC-2"]


def test_a_run_at_work_is_not_kept(site, address, drawn):
    with Store(address) as store:
        run, _ = store.begin(RunRow("plant", digest="d3", code="0.1.0", began=START + timedelta(days=30)))
        store.put_loops(run, [store.loop("FIC-2")])
        store.put_screened(run, [Screened((finding("FIC-2"),))])
        site.text(f"/?run={run}")
        before = len(drawn)
        site.text(f"/?run={run}")
        assert len(drawn) == before + 1
        store.finish(run)


def test_who_has_the_answer_already_is_told_so(site):
    for path in ("/", "/api/v1/loops"):
        first = site.ask(path)
        tag = first.headers["etag"]
        again = site.ask(path, headers={"If-None-Match": f'"other", W/{tag}'})
        assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
        assert site.ask(path, headers={"If-None-Match": '"other"'}).content == first.content
    site.ask("/loops/FIC-1/review", "POST", data={"state": "accepted", "who": "Ada"})
    assert site.ask("/api/v1/loops", headers={"If-None-Match": tag}).status_code == 200


@pytest.mark.parametrize("path", ["/?run=77", "/plant/nothing", "/api/v1/loops/NONE"])
def test_errors_are_not_kept(site, path):
    assert [site.ask(path).status_code for _ in range(2)] == [404, 404]
    assert "etag" not in site.ask(path).headers


def test_what_is_kept_has_an_end():
    kept = Kept(100, len)
    for number in range(50):
        kept.put(number, 1, "x" * 30)
    assert [number for number in range(50) if kept.get(number, 1)] == [47, 48, 49]
    kept.put(49, 2, "y" * 90)
    assert (kept.get(49, 1), kept.get(49, 2), kept.get(48, 1)) == (None, "y" * 90, None)
    kept.put(50, 2, "z" * 101)
    assert kept.get(50, 2) is None, "larger than all that may be kept"
