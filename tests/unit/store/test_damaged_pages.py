"""Stores of which pages are damaged: each command and page says so in one line, or shows what is there."""

import logging

import numpy as np
import pytest

from lostmotion.cli import main
from lostmotion.errors import LostMotionError
from lostmotion.store.encoded import coded, decoded
from lostmotion.store.rows import AssessmentRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, RunRow
from tests.support.plant_stores import plant_store

PAGE = 4096  # bytes
OTHER = {"text": 7, "float": "x", "int": "x", "bool": "x", "moment": "x", "bytes": "x", "json": b"x"}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sound")
    plant_store(folder, data=False)
    return (folder / "plant.db").read_bytes()


def damaged(data, random):
    """One to three pages zeroed, overwritten, hurt, or taken from elsewhere; a file cut short now and then."""
    made, pages = bytearray(data), len(data) // PAGE
    for _ in range(int(random.integers(1, 4))):
        page = PAGE * int(random.integers(pages))
        ways = (
            bytes(PAGE),
            random.bytes(PAGE),
            made[(other := PAGE * int(random.integers(pages))) : other + PAGE],
            bytes(random.integers(256) if random.random() < 3e-3 else byte for byte in made[page : page + PAGE]),
            bytes(random.integers(256, size=100).tolist()) + made[page + 100 : page + PAGE],
        )
        made[page : page + PAGE] = ways[int(random.integers(len(ways)))]
    return bytes(made[: int(random.integers(len(made)))] if random.random() < 0.1 else made)


@pytest.mark.sampled(16)
@pytest.mark.parametrize("number", range(64))
def test_a_damaged_page_is_one_line(sound, number, tmp_path, capsys):
    store = tmp_path / "plant.db"
    store.write_bytes(damaged(sound, np.random.default_rng([23, number])))
    shown = ["audit", "--show", store, "--report", tmp_path / "r.html", "--report-loops", tmp_path / "loops"]
    for words in (["audit", "--show", store], shown, ["audit", "--upgrade", store]):
        code = 0
        try:
            main(list(map(str, words)))
        except SystemExit as ended:
            code = ended.code
        assert code in (0, 1, None)
        said = capsys.readouterr().err
        assert said.count("\n") <= 1
        assert "Traceback" not in said


@pytest.mark.sampled(16)
@pytest.mark.parametrize("number", range(64))
def test_a_damaged_page_is_an_answer_of_the_web_page(sound, number, tmp_path):
    pytest.importorskip("starlette")
    from lostmotion.web.page import Page
    from tests.unit.web.test_plant import Site

    store = tmp_path / "plant.db"
    store.write_bytes(damaged(sound, np.random.default_rng([23, number])))
    logging.disable(logging.CRITICAL)
    try:
        site = Site(Page(str(store)))
    except LostMotionError:
        return
    finally:
        logging.disable(logging.NOTSET)
    for path in ("/", "/loops/FIC-1", "/plant/groups", "/api/v1/loops", "/api/v1/news"):
        assert site.ask(path).status_code in (200, 400, 404, 503)


@pytest.mark.parametrize("kind", [AssessmentRow, LoopRow, ReviewRow, RunRow])
def test_a_value_of_another_type_is_none_of_ours(kind):
    fields = coded(kind)
    good = {one.column: None for one in fields}
    for one in fields:
        rest = {other.name: None for other in fields if other.name != one.name}
        for value in [OTHER[one.kind], *([] if one.optional else [None])]:
            with pytest.raises(ValueError, match=f"as {one.column}"):
                decoded(kind, good | {one.column: value}, **rest)
