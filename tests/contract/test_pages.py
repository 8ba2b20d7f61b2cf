"""Every page says at which commit it was made, and every figure of the README is that of a page."""

import re

from benchmarks.pages.ages import oldest_first
from benchmarks.pages.catalogue import BY_HAND, PAGES
from benchmarks.pages.commit import ROOT
from benchmarks.pages.footer import footer_of
from benchmarks.pages.quoted import EXCERPTS, GIVEN, QUOTES
from benchmarks.pages.quotes import absent, differences, excerpt_differences, uncovered

README = (ROOT / "README.md").read_text(encoding="utf-8")
NAMES = [page.name for page in PAGES]
DOCS = sorted((ROOT / "docs").glob("*.md"))


def test_no_page_is_of_an_earlier_release():
    behind = {one.page.name: one.state for one in oldest_first() if one.behind}
    assert behind == {}, "run `make pages` before a release"


def test_every_page_is_in_the_catalogue():
    scripts = {page.name: page.script for page in PAGES}
    assert not set(scripts) & set(BY_HAND)
    assert set(scripts) | set(BY_HAND) == {path.stem for path in DOCS}
    for path in DOCS:
        footer = footer_of(path.read_text(encoding="utf-8"))
        assert footer is None if path.stem in BY_HAND else footer.script == scripts[path.stem], path


def test_every_page_can_be_reached():
    texts = {path: path.read_text(encoding="utf-8") for path in [ROOT / "README.md", *DOCS]}
    assert [one for one in DOCS if not any(one.name in text for path, text in texts.items() if path != one)] == []


def test_catalogue_and_scripts_agree():
    scripts = ROOT.glob("benchmarks/*.py")
    writers = {path.relative_to(ROOT).as_posix() for path in scripts if "publish(" in path.read_text(encoding="utf-8")}
    assert writers == {page.script for page in PAGES if page.script.startswith("benchmarks/")}


def test_scripts_say_their_page_and_their_minutes():
    for page in PAGES:
        said = " ".join((ROOT / page.script).read_text(encoding="utf-8").split('"""')[1].split())
        assert f"writes {page.file}" in said, page
        assert float(re.search(r"about (\d+) minute", said)[1]) == page.minutes, page


def test_pages_named_in_the_source_are_known():
    for folder in ("src", "benchmarks", "examples"):
        for path in (ROOT / folder).rglob("*.py"):
            if "tests" in path.parts:
                continue
            for name in re.findall(r"docs/([a-z-]+)\.md", path.read_text(encoding="utf-8")):
                assert name in NAMES or name in BY_HAND, (path, name)


def test_figures_are_those_of_the_pages():
    assert differences(QUOTES) == []


def test_every_number_of_the_readme_has_a_source():
    assert uncovered(README, QUOTES, GIVEN) == []


def test_what_is_given_is_there():
    assert absent(README, GIVEN) == []


def test_quotes_hold_no_figures_of_their_own():
    for quote in QUOTES:
        assert uncovered(re.sub(r"\{[^}]*\}", "{}", quote.says), [], GIVEN) == []


def test_excerpts_are_of_their_pages():
    assert excerpt_differences(README, EXCERPTS) == []


def test_a_wrong_figure_is_found():
    for found in re.finditer(r"97\.4 %|149 loops|8\.7 \.\. 11\.8 in", README):
        wrong = README[: found.start()] + "1" + README[found.start() :]
        assert differences(QUOTES, text=wrong)
    assert uncovered(README + "\nIt is 17 times faster.\n", QUOTES, GIVEN) == [
        f"17 in line {README.count(chr(10)) + 2}"
    ]
