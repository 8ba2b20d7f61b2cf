"""Pages that know their age, on a toy repository: commits, footers, writing, making again, kept parts, quotes."""

import subprocess
import sys
from dataclasses import replace
from datetime import date

import pytest
from benchmarks.pages import ages, kept, publish
from benchmarks.pages.by_hand import NOTE, PLACE, carried, judged_commit
from benchmarks.pages.catalogue import Page
from benchmarks.pages.commit import ROOT, commit
from benchmarks.pages.footer import Footer, footer_of, release, signed, unsigned
from benchmarks.pages.make import make
from benchmarks.pages.publish import replace_text
from benchmarks.pages.quotes import Quote, absent, differences, excerpt_differences, mend, shown, uncovered
from benchmarks.pages.tables import PageText, QuoteError

FILES = {
    "src/lostmotion/__init__.py": '__version__ = "0.2.0"\n',
    "src/lostmotion/near.py": "value = 1\n",
    "benchmarks/toy.py": "import lostmotion as lm\n",
    ".gitignore": ".cache\n",
}
TOY = Page("toy", "benchmarks/toy.py", 1)
# a script as those of benchmarks/ are, but for the repository that it is told
WRITER = """import sys
sys.path.insert(0, {root!r})
from pathlib import Path
from benchmarks.pages.by_hand import NOTE, PLACE, carried, judged_commit
from benchmarks.pages.catalogue import Page
from benchmarks.pages.publish import publish
here = Path(__file__).resolve().parents[1]
{before}
publish(here / "docs" / "{name}.md", "# {name}\\n", [Page("{name}", "benchmarks/{name}.py", 1)], here)
"""


@pytest.fixture
def root(tmp_path):
    for name, text in FILES.items():
        write(tmp_path, name, text)
    git(tmp_path, "init", "-q")
    committed(tmp_path)
    return tmp_path


def git(root, *words):
    who = ("-c", "user.name=toy", "-c", "user.email=toy@localhost")
    done = subprocess.run(["git", *who, *words], cwd=root, check=True, capture_output=True, text=True)  # noqa: S607
    return done.stdout.strip()


def committed(root):
    git(root, "add", "-A")
    git(root, "commit", "-q", "--allow-empty", "-m", "toy")
    return git(root, "rev-parse", "--short=12", "HEAD")


def write(root, name, text):
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def script(root, name, before=""):
    write(root, f"benchmarks/{name}.py", WRITER.format(root=str(ROOT), name=name, before=before))
    return Page(name, f"benchmarks/{name}.py", 1)


class TestCommit:
    def test_what_was_changed_since_is_told(self, root):
        assert commit(root) == git(root, "rev-parse", "--short=12", "HEAD")
        write(root, "docs/toy.md", "# Toy\n")
        assert "+" not in commit(root), "a page is not what it measures"
        write(root, "src/lostmotion/near.py", "value = 2\n")
        assert commit(root).endswith("+")

    def test_no_repository(self, tmp_path):
        assert commit(tmp_path) == "unknown"


class TestFooter:
    LAST = Footer(date(2026, 1, 31), "benchmarks/toy.py", "0123456789ab", "0.2.0", 12)

    @pytest.mark.parametrize("minutes", [None, 1, 12])
    def test_way_there_and_back(self, minutes):
        footer = Footer(date(2026, 1, 31), "benchmarks/toy.py", "0123456789ab", "0.2.0", minutes)
        page = signed("# Toy\n\nWords.\n", footer)
        assert footer_of(page) == footer
        assert unsigned(page).rstrip() == "# Toy\n\nWords."

    def test_signed_again_has_one_footer(self):
        other = Footer(date(2026, 2, 1), "benchmarks/toy.py", "ba9876543210", "0.10.0")
        page = signed(signed("# Toy\n", self.LAST), other)
        assert page.count("*Made on") == 1
        assert footer_of(page) == other

    def test_only_the_last_line_counts(self):
        assert footer_of(f"# Toy\n\n{self.LAST}\n\nMore words.\n") is None

    def test_releases_are_numbers(self):
        assert release("0.9.0") < release("0.10.0")


class TestPublish:
    def test_page_is_fresh(self, root):
        write(root, "docs/toy.md", "old")
        publish_toy(root)
        age = ages.age(TOY, root)
        assert (age.fresh, age.behind, age.state) == (True, False, "of this commit")
        assert age.minutes >= 1

    def test_old_page_stays_where_writing_fails(self, root):
        write(root, "docs/toy.md", "old")
        with pytest.raises(UnicodeEncodeError):
            replace_text(root / "docs" / "toy.md", "half \udc00")
        assert (root / "docs" / "toy.md").read_text(encoding="utf-8") == "old"
        assert [path.name for path in (root / "docs").iterdir()] == ["toy.md"]

    def test_unknown_page_is_refused(self, root):
        with pytest.raises(LookupError, match="a page of the catalogue"):
            publish(root / "docs" / "other.md", "text", [TOY], root)

    def test_of_this_version_and_behind(self, root):
        publish_toy(root)
        write(root, "src/lostmotion/near.py", "value = 2\n")
        committed(root)
        age = ages.age(TOY, root)
        assert (age.fresh, age.behind, age.state) == (False, False, "of this version")
        write(root, "src/lostmotion/__init__.py", '__version__ = "0.10.0"\n')
        assert ages.age(TOY, root).state == "of version 0.2.0"

    def test_page_that_is_not_there_is_behind(self, root):
        age = ages.age(TOY, root)
        assert (age.fresh, age.behind, age.state) == (False, True, "not made")


def publish_toy(root):
    publish(root / "docs" / "toy.md", "# Toy\n", [TOY], root)


class TestWordsByHand:
    def test_carried_over_and_dated(self):
        template = f"# Toy\n\n{PLACE}\n\nRows.\n"
        first = carried(template, "", "aaa")
        assert judged_commit(first) == "unknown"
        assert NOTE in first
        written = first.replace("commit unknown", "commit aaa").replace(NOTE, "It holds.\n\n")
        same, newer, newest = (carried(template, written, at) for at in ("aaa", "bbb", "ccc"))
        assert same == written
        assert NOTE + "It holds." in newer
        assert judged_commit(newer) == "aaa"
        assert carried(template, newer, "ccc") == newest == newer
        assert carried(template, newer, "aaa") == written

    def test_page_without_place(self):
        old = "<!-- by hand, for commit aaa -->\nIt holds.\n<!-- end of the words by hand -->"
        assert carried("# Toy\n", "# Old\n", "aaa") == "# Toy\n"
        assert carried("# Toy\n", old, "aaa") == f"# Toy\n\n{old}\n"

    def test_told_in_the_list(self, root):
        publish(root / "docs" / "toy.md", f"# Toy\n\n{PLACE}\n", [TOY], root)
        age = ages.age(TOY, root)
        assert (age.unread, age.state) == (True, "of this commit, words older")


class TestMake:
    def test_oldest_first_failures_told_fresh_left_alone(self, root):
        pages = [
            script(root, "good"),
            script(root, "bad", "print('the reason'); sys.exit(3)"),
            script(root, "mute", "sys.exit(0)"),
        ]
        write(root, "docs/good.md", signed("# Old\n", TestFooter.LAST))
        write(root, "docs/bad.md", signed("# Old\n", TestFooter.LAST))
        committed(root)
        told = []
        outcome = make(pages=pages, root=root, tell=told.append)
        assert [line.split()[0] for line in told if " by " in line] == ["docs/mute.md", "docs/bad.md", "docs/good.md"]
        assert outcome.made == ["good"]
        assert outcome.failed == {"bad": "exit code 3\n    the reason", "mute": "the script ran and wrote no page"}
        assert (root / "docs" / "bad.md").read_text(encoding="utf-8").startswith("# Old")
        again = make(pages=pages, root=root, tell=told.append)
        assert "good" not in again.made
        assert set(again.failed) == {"bad", "mute"}

    def test_time_is_kept(self, root):
        outcome = make(most_minutes=-1.0, pages=[script(root, "good")], root=root, tell=lambda _: None)
        assert (outcome.made, outcome.left) == ([], ["good"])
        assert "left for another time: good" in str(outcome)

    def test_named_pages_are_made_though_fresh(self, root):
        page = script(root, "good")
        committed(root)
        for only in ((), ("good",)):
            assert make(only, pages=[page], root=root, tell=lambda _: None).made == ["good"]
        assert make(pages=[page], root=root, tell=lambda _: None).made == []

    def test_beside_each_other_only_where_they_share(self, root):
        """Each page waits for the other to begin; the one that stands alone finds none beside it."""
        wait = "import time; (here / '{0}').touch(); end = time.time() + 20"
        until = "\nwhile not (here / '{1}').exists(): assert time.time() < end; time.sleep(0.01)"
        pages = [script(root, name, (wait + until).format(name, other)) for name, other in (("a", "b"), ("b", "a"))]
        alone = script(root, "alone", "assert (here / 'docs' / 'a.md').exists() and (here / 'docs' / 'b.md').exists()")
        shared = [replace(page, shares=True) for page in pages]
        outcome = make(at_once=2, pages=[alone, *shared], root=root, tell=lambda _: None)
        assert outcome.failed == {}
        assert sorted(outcome.made) == ["a", "alone", "b"]

    def test_unknown_name(self, root):
        with pytest.raises(LookupError, match="expected names of pages, got gone; choose among good"):
            make(["gone"], pages=[script(root, "good")], root=root)


class TestKept:
    def test_done_once_at_a_commit(self, root):
        calls = []

        def work():
            calls.append(1)
            return "row", 2.5

        assert [kept("toy", "first, 3 seeds", work, TOY, root) for _ in range(2)] == [["row", 2.5]] * 2
        kept("toy", "first, 4 seeds", work, TOY, root)
        assert len(calls) == 2

    def test_gone_when_the_page_is_there(self, root):
        kept("toy", "part", lambda: 1, TOY, root)
        assert (root / ".cache" / "pages" / "toy").is_dir()
        publish_toy(root)
        assert not (root / ".cache" / "pages" / "toy").exists()

    def test_another_commit_begins_anew(self, root):
        old = root / ".cache" / "pages" / "toy" / "000000000000" / "part.json"
        write(root, old.relative_to(root).as_posix(), "1")
        assert kept("toy", "part", lambda: 2, TOY, root) == 2
        assert not old.exists()

    def test_numbers_of_numpy(self, root):
        numpy = pytest.importorskip("numpy")
        assert kept("toy", "part", lambda: [numpy.int64(2), numpy.float64(0.1)], TOY, root) == [2, 0.1]

    def test_too_large(self, root):
        with pytest.raises(ValueError, match="keep rows only"):
            kept("toy", "part", lambda: "x" * 2**21, TOY, root)


PAGE = """# Toy

It is 4.20 times
faster, on **12** loops.

| row | size | said |
|---|---|---|
| first | 1,000 | 3/4 |
| first, again | 20 | 4/4 (97 %) |

| other | size |
| --- | --- |
| first | -7 |
"""


class TestTables:
    page = PageText("toy", PAGE)

    def test_cells_and_numbers(self):
        assert self.page.cell("first", "said") == "3/4"
        assert self.page.number("first, again", "size") == 20
        assert self.page.numbers("first", "size") == [1000, -7]
        assert self.page.numbers("fir", "size") == [1000, 20, -7]
        assert self.page.numbers("", "said") == [3, 4, 4, 4, 97]

    def test_rows_by_another_cell(self):
        assert self.page.rows("said", size="20") == [["first, again", "20", "4/4 (97 %)"]]

    def test_sentences_over_lines(self):
        assert self.page.said("is # times faster") == [4.2]

    @pytest.mark.parametrize(
        "read", [lambda p: p.cell("gone", "size"), lambda p: p.said("is # slow"), lambda p: p.rows("x")]
    )
    def test_what_is_not_there(self, read):
        with pytest.raises(QuoteError, match=r"docs/toy\.md"):
            read(self.page)


class TestQuotes:
    QUOTE = Quote(
        "it is {:.1f} times faster on {:,.0f} rows", "toy", lambda p: [*p.said("is # times"), p.number("first", "size")]
    )
    TEXT = "# Read me\n\nWe say it is 4.2 times\nfaster on 1,000 rows, since 2010; see `x = 3`.\n"

    @pytest.fixture(autouse=True)
    def texts(self, root):
        write(root, "docs/toy.md", PAGE)
        write(root, "README.md", self.TEXT)

    def test_right(self, root):
        assert differences([self.QUOTE], root) == []

    @pytest.mark.parametrize("wrong", [("4.2", "4.3"), ("1,000", "1,001"), ("times\nfaster", "times slower")])
    def test_wrong(self, root, wrong):
        write(root, "README.md", self.TEXT.replace(*wrong))
        assert len(differences([self.QUOTE], root)) == 1

    def test_page_that_says_it_no_longer(self, root):
        write(root, "docs/toy.md", "# Toy\n")
        assert "no longer says" in differences([self.QUOTE], root)[0]

    def test_mend_changes_figures_and_keeps_lines(self, root):
        write(root, "README.md", self.TEXT.replace("4.2", "99").replace("1,000", "5"))
        assert len(list(mend([self.QUOTE], root))) == 1
        assert (root / "README.md").read_text(encoding="utf-8") == self.TEXT

    def test_shown_with_the_commit(self, root):
        write(root, "docs/toy.md", signed(PAGE, TestFooter.LAST))
        assert list(shown([self.QUOTE], root)) == [
            "README.md: it is 4.2 times faster on 1,000 rows\n"
            "    docs/toy.md, commit 0123456789ab, 2026-01-31, benchmarks/toy.py"
        ]

    def test_number_without_a_source(self):
        assert uncovered(self.TEXT, [self.QUOTE], ["since 2010"]) == []
        assert uncovered(self.TEXT, [self.QUOTE], []) == ["2010 in line 4"]
        assert uncovered(self.TEXT, [], ["since 2010"]) == ["4.2 in line 3", "1,000 in line 4"]

    def test_given_and_absent(self):
        assert absent(self.TEXT, ["times faster", "since 2011"]) == ["since 2011"]

    def test_excerpt(self, root):
        readme = "```\n$ toy\n| first | 1,000 | 3/4 |\n| first | 1,001 | 3/4 |\n```\n"
        assert excerpt_differences(readme, {"$ toy": "toy"}, root) == [
            "docs/toy.md has no line '| first | 1,001 | 3/4 |'"
        ]


def test_command_line_says_its_options():
    words = [sys.executable, "-m", "benchmarks.pages", "--help"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    assert "--most-minutes" in done.stdout
