"""Files on the desk of which somebody has changed what is kept: one bad item is one bad item."""

import json

import numpy as np
import pytest

from lostmotion.files.results import write_json
from lostmotion.web.desk.desk import Desk
from lostmotion.web.desk.item import ABOUT, Item
from lostmotion.web.worker.task import BRIEF, EXPORT, LOOK, RESULT, STUDY, brief_of
from tests.support.hostile_values import mutants
from tests.unit.web import test_files

SOUND, BAD = "0" * 16, "1" * 16
KEPT = {
    ABOUT: Item(BAD, None, "bad.csv", ("/x/bad.csv",), came="2026-03-02T00:00:00+00:00", asked={"op": "t"}),
    LOOK: test_files.LOOK, RESULT: test_files.RESULT, STUDY: test_files.STUDY, BRIEF: brief_of(test_files.RESULT, "ok"),
    EXPORT: {"title": "ST", "file": "FY_1.zip", "said": "s", "files": []},
}  # fmt: skip
PATHS = ("", "/columns", "/report.html", "/diagnosis.json", "/fit.json", "/study.json", "/block.zip")


@pytest.fixture
def folder(tmp_path):
    for number in (SOUND, BAD):
        (tmp_path / number).mkdir()
        for name, data in KEPT.items():
            write_json(tmp_path / number / name, data.about() if name == ABOUT else data)
    return tmp_path


def asked(folder, *paths):
    """Status and text of each answer."""
    desk = Desk(keep=folder)
    try:
        return [(one.status_code, one.text) for one in (test_files.ask(desk, "GET", path) for path in paths)]
    finally:
        desk.close()


def shown(folder):
    """The lists, which must hold the sound item; and all that is about the bad one."""
    lists = asked(folder, "/files", "/api/v1/files", *(f"/files/{BAD}{path}" for path in PATHS))
    assert [status for status, _ in lists[:2]] == [200, 200]
    assert all(SOUND in text for _, text in lists[:2])
    return {status for status, _ in lists[2:]}


@pytest.mark.parametrize("name", list(KEPT))
@pytest.mark.parametrize("data", [b"", b"{}", b"[]", b"null", b'{"words": 1', b"\xff\0", b'{"a": NaN}'])
def test_a_broken_file_of_one_item_is_one_bad_item(folder, name, data):
    (folder / BAD / name).write_bytes(data)
    assert shown(folder) <= {200, 404, 409}


@pytest.mark.sampled(8)
@pytest.mark.parametrize(("name", "seed"), [(name, seed) for name in KEPT for seed in range(4)])
def test_any_value_of_any_kept_file_is_one_bad_item(folder, name, seed):
    sound = json.loads((folder / BAD / name).read_text())
    random = np.random.default_rng(seed)
    for data in mutants(sound, random, 20.0 / (40 * len(list(_places(sound))))):
        (folder / BAD / name).write_text(json.dumps(data))
        assert shown(folder) <= {200, 404, 409}, (name, data)


def _places(value):
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    yield value
    for one in inner:
        yield from _places(one)


def test_what_cannot_be_shown_offers_the_ways_on(folder):
    (folder / BAD / STUDY).write_text(json.dumps({**test_files.STUDY, "steps": 7}))
    status, text = asked(folder, f"/files/{BAD}")[0]
    assert status == 409
    assert "is damaged" in text
    assert f"/files/{BAD}/again" in text
    assert f"/files/{BAD}/remove" in text
