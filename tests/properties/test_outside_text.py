"""Whatever a file is called and whatever reason is typed: the exported code is the same, apart from its comments."""

import shutil
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.export import TARGETS, outside
from lostmotion.export.commissioning import page
from lostmotion.export.dialects import restore
from tests.support.hostile_texts import bare, exported, source_with, texts

LANGUAGES = (outside.anywhere, outside.structured_text, outside.scl, outside.c99, outside.markdown)
OTHERS = [to for to in TARGETS if to != "c"]


@cache
def harmless(target):
    return bare(exported(target, "FIC-101.csv"))


@given(text=texts | st.text())
def test_every_language_lets_through_one_short_line_of_what_it_allows(text):
    for language in LANGUAGES:
        said = language(text)
        assert said.isascii()
        assert said.isprintable()
        assert len(said) <= outside.LONGEST
        assert not set(said) & set("*\\\"'{}[]<>$")
        assert language(said) == said
    assert not set(outside.c99(text)) & set("?")
    assert not set(outside.markdown(text)) & set("|`&!#")
    assert "--" not in outside.anywhere(text)


def test_what_a_person_writes_stays_readable():
    assert outside.c99("Schätzung für FIC-101, 5 % (a/b): 'gut'") == "Schatzung fur FIC-101, 5 % (a/b): `gut`"
    assert outside.c99("a" * 5000).endswith(" ..")


@pytest.mark.parametrize("to", OTHERS)
@given(text=texts)
@settings(max_examples=15, deadline=None)
def test_the_same_file_apart_from_comments(to, text):
    assert bare(exported(to, text)) == harmless(to)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs the preprocessor of gcc")
@given(text=texts)
@settings(max_examples=15, deadline=None)
def test_the_same_c_to_the_preprocessor(text):
    assert bare(exported("c", text)) == harmless("c")


@pytest.mark.parametrize("to", TARGETS)
def test_the_texts_that_broke_out_before(to):
    for text in (
        r"x *\ int pwned; \*.csv",
        "x \uff0a\uff0f int pwned; /\uff0a",
        "x *\uff3c int pwned; \uff3c*",
        "??/\n*/",
    ):
        if to != "c" or shutil.which("gcc"):
            assert bare(exported(to, text)) == harmless(to)


@pytest.mark.parametrize("to", TARGETS)
@given(text=texts)
@settings(max_examples=8, deadline=None)
def test_what_is_read_back_for_the_replay_is_the_same(to, text):
    assert _code(restore(exported(to, text))) == _code(restore(exported(to, "FIC-101.csv")))


def _code(text):
    from lostmotion.export.reader import _tokens

    return _tokens(text)


@given(text=texts)
@settings(max_examples=15, deadline=None)
def test_the_commissioning_page_keeps_its_form(text):
    def marks(said):
        whole = page(source_with(said), TARGETS["st"], ["FY_101.st"])
        return [line[:2] for line in whole.splitlines()], {sign: whole.count(sign) for sign in "`|<>[]*"}

    assert marks(text) == marks("FIC-101.csv")
