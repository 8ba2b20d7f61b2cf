"""A loop list is what it was after writing and reading, whatever is in it."""

from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.plant import PlantLoop, loop_list_text, parse_loop_list
from lostmotion.plant.address import Place, parsed, written
from lostmotion.plant.loop_list import TYPES

letters = st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp"))
words = st.text(letters, max_size=12).map(str.strip)
tags = st.text(letters, min_size=1, max_size=12).map(str.strip).filter(lambda tag: tag and not tag.startswith("#"))
numbers = st.floats(-1e9, 1e9).map(lambda value: value + 0.0)
spans = st.none() | st.tuples(numbers, numbers).filter(lambda span: span[0] < span[1])
roles = st.one_of(st.just(("", "")), st.tuples(words.filter(bool), words.filter(bool)))


@st.composite
def loops(draw):
    op, pv = draw(roles)
    return PlantLoop(
        draw(tags), op, pv, draw(words), draw(words), draw(st.sampled_from(("", *TYPES))), draw(spans), draw(spans),
        draw(words), draw(words), draw(words), draw(st.floats(0.0, 1e6)), draw(words),
        notes=tuple(filter(None, [draw(words)])), dt=draw(st.none() | st.floats(1e-6, 1e6)), time=draw(words),
    )  # fmt: skip


@settings(max_examples=40)
@given(st.lists(loops(), min_size=1, max_size=6, unique_by=lambda loop: loop.tag))
def test_there_and_back(given_loops):
    found = parse_loop_list(loop_list_text(given_loops))
    assert found.loops == tuple(given_loops)
    assert found.notes == ()


names = st.text(min_size=1, max_size=8)
places = st.builds(Place, st.lists(names, min_size=1, max_size=3).map(tuple), st.just("") | names)


@settings(max_examples=40)
@given(st.lists(places, min_size=1, max_size=3))
def test_addresses_there_and_back(given_places):
    assert parsed(written(given_places)) == tuple(given_places)
