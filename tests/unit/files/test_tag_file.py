"""Names of files of tags: one for each tag on every system, none of them a path or a device."""

import itertools

import pytest

from lostmotion.files.tag_file import tag_file

PIECES = ("a", "A", "/", "..", ".", " ", "%", "%2F", "%-", "\\", ":", "\0", "\n", "CON", "aux", "\u00e9", "e\u0301",
          "\ud800", "\u202e", "~1", "*", "?", "<", "|", '"', "FIC101", "report.html", "x" * 3000)  # fmt: skip
TAGS = [
    "",
    *dict.fromkeys(map("".join, itertools.chain(itertools.product(PIECES), itertools.product(PIECES, repeat=2)))),
]
DEVICES = ("CON", "con", "AUX", "NUL.x", "COM1", "lpt9", "PRN.tar.gz", "CONIN$")


def test_every_tag_has_its_own_name_where_capitals_are_small_letters():
    names = {tag_file(tag, ".state").casefold().rstrip(" .") for tag in (*TAGS, *DEVICES)}
    assert len(names) == len({*TAGS, *DEVICES})


@pytest.mark.parametrize(
    "tag", [*TAGS[:40], *DEVICES, "A/report.html", "FIC:101", "A ", "A.", " A", ".A", "x" * 100_000]
)
def test_a_name_is_a_name_everywhere(tag):
    name = tag_file(tag, ".state")
    assert name.endswith(".state")
    assert len(name.encode()) <= 200
    assert set(name) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 _.-~%")
    assert name.strip(" .") == name
    assert name.split(".", 1)[0].upper() not in ("CON", "AUX", "NUL", "PRN", "COM1", "LPT9")


@pytest.mark.parametrize("tag", ["FIC-101", "LIC 7", "AREA_2.FIC", "FIC/101"])
def test_usual_tags_are_read_in_a_folder(tag):
    assert tag_file(tag, ".state") == f"{tag.replace('/', '%2F')}.state"
