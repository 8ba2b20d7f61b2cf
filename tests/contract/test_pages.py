"""Every page says from which source it is, and every figure of the README is that of a page."""

import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from benchmarks.pages.ages import oldest_first
from benchmarks.pages.catalogue import BY_HAND, PAGES
from benchmarks.pages.footer import footer_of
from benchmarks.pages.quoted import EXCERPTS, GIVEN, QUOTES
from benchmarks.pages.quotes import absent, differences, excerpt_differences, uncovered
from benchmarks.pages.sources import ROOT, sources

README = (ROOT / "README.md").read_text(encoding="utf-8")
NAMES = [page.name for page in PAGES]


@pytest.fixture(scope="module")
def ages():
    return {one.page.name: one for one in oldest_first()}


@pytest.mark.parametrize("name", NAMES)
def test_page_is_of_this_release(ages, name):
    assert not ages[name].behind, f"{ages[name].state}; run `make pages` before a release"


@pytest.mark.filterwarnings("default")
def test_stale_pages_are_listed(ages):
    stale = [f"docs/{name}.md ({one.minutes:g} minutes)" for name, one in ages.items() if one.stale]
    if stale:
        warnings.warn(f"{len(stale)} pages are older than the source: {', '.join(stale)}", stacklevel=1)
    unread = [f"docs/{name}.md" for name, one in ages.items() if one.unread]
    if unread:
        warnings.warn(f"words by hand are older than the tables beside them: {', '.join(unread)}", stacklevel=1)


@pytest.mark.parametrize("path", sorted((ROOT / "docs").glob("*.md")), ids=lambda path: path.stem)
def test_page_is_in_the_catalogue(path):
    footer = footer_of(path.read_text(encoding="utf-8"))
    scripts = {page.name: page.script for page in PAGES}
    assert (path.stem in BY_HAND) != (path.stem in scripts)
    assert footer is None if path.stem in BY_HAND else footer.script == scripts[path.stem]


@pytest.mark.parametrize("path", sorted((ROOT / "docs").glob("*.md")), ids=lambda path: path.stem)
def test_page_can_be_reached(path):
    others = [ROOT / "README.md", *(page for page in (ROOT / "docs").glob("*.md") if page != path)]
    assert any(path.name in other.read_text(encoding="utf-8") for other in others)


def test_catalogue_and_scripts_agree():
    scripts = ROOT.glob("benchmarks/*.py")
    writers = {path.relative_to(ROOT).as_posix() for path in scripts if "publish(" in path.read_text(encoding="utf-8")}
    assert writers == {page.script for page in PAGES if page.script.startswith("benchmarks/")}


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_script_says_its_page_and_its_minutes(page):
    said = " ".join((ROOT / page.script).read_text(encoding="utf-8").split('"""')[1].split())
    assert f"writes {page.file}" in said
    assert float(re.search(r"about (\d+) minute", said)[1]) == page.minutes
    assert all(list(ROOT.glob(pattern)) for pattern in page.also)


def test_pages_named_in_the_source_are_known():
    for folder in ("src", "benchmarks", "examples"):
        for path in (ROOT / folder).rglob("*.py"):
            for name in re.findall(r"docs/([a-z-]+)\.md", path.read_text(encoding="utf-8")):
                assert name in NAMES or name in BY_HAND, (path, name)


@pytest.mark.parametrize(("script", "fewest"), [("speed", 10), ("startup", 5), ("diagnosis", 10)])
def test_sources_hold_all_that_python_imports(script, fewest):
    """Python itself says what importing a script loads; what runs later can only be more of the same graph."""
    path = ROOT / "benchmarks" / f"{script}.py"
    code = (
        f"import runpy, sys; sys.path.insert(0, {str(path.parent)!r}); runpy.run_path({str(path)!r}, run_name='x');"
        "print(*{m.__file__ for m in sys.modules.values() if getattr(m, '__file__', None)}, sep='\\n')"
    )
    tree = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT, env=tree)
    loaded = {Path(line) for line in done.stdout.splitlines() if Path(line).is_relative_to(ROOT)}
    loaded = {path for path in loaded if ".venv" not in path.parts and "pages" not in path.relative_to(ROOT).parts}
    assert len(loaded) > fewest  # packages load lazily: the commands that start-up measures run elsewhere
    assert loaded <= set(sources(path))


def test_sources_tell_scripts_apart():
    design = ROOT / "src" / "lostmotion" / "design" / "plan.py"
    assert design in sources(ROOT / "benchmarks" / "design.py")
    assert design not in sources(ROOT / "benchmarks" / "accuracy.py")


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
