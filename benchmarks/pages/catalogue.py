"""Every page of ``docs/``, and who writes it."""

from __future__ import annotations

from dataclasses import dataclass

REMARKS = "src/lostmotion/report/remarks_on_fit.py"  # loaded by the verb of a fit
REPORT = "src/lostmotion/report/diagnosis_*.py"
READERS = "src/lostmotion/files/read_any.py"  # loaded where a verb is given a path or a frame
SHARED = "the real records in ../shared/data"
COMMANDS = "src/lostmotion/cli/*.py"  # run as processes, and loaded by their names
EXPORT = ("benchmarks/export.md", "src/lostmotion/export/templates/*")
SUPERVISED = ("benchmarks/supervised.md", "src/lostmotion/export/templates/*")
RIVALS = ("benchmarks/rivals/*.py", "benchmarks/rivals-constraints.txt", COMMANDS)


@dataclass(frozen=True)
class Page:
    """A page that a script writes.

    Attributes
    ----------
    name : str
        Of ``docs/NAME.md``.
    script : str
        Relative to the repository.
    minutes : float
        Expected, on two cores that do nothing else.
    also : tuple of str
        Patterns of files that the script depends on without importing them.
    needs : str
        What must be there before.
    reads : bool
        Whether its script hands files or data frames to the verbs; one that does not depends on no reader.
    shares : bool
        Whether its script may run beside another: it keeps to one core, and its page holds no times.
    """

    name: str
    script: str
    minutes: float
    also: tuple[str, ...] = ()
    needs: str = ""
    reads: bool = False
    shares: bool = False

    @property
    def without(self) -> tuple[str, ...]:
        """What its script imports in vain."""
        return () if self.reads else (READERS,)

    @property
    def file(self) -> str:
        """The page, relative to the repository."""
        return f"docs/{self.name}.md"


PAGES = (
    Page("accuracy", "benchmarks/accuracy.py", 5),
    Page("adaptive", "benchmarks/adaptive.py", 15, ("benchmarks/adaptive.md",), reads=True, shares=True),
    Page("blocks", "benchmarks/blocks.py", 6),
    Page("clean-bill", "benchmarks/clean_bill.py", 6),
    Page(
        "commissioning-example",
        "examples/virtual_commissioning.py",
        1,
        ("tests/plc/*.py",),
        "make plc",
        reads=True,
        shares=True,
    ),
    Page("compensation", "benchmarks/compensation.py", 2, ("benchmarks/compensation.md",), shares=True),
    Page("compensation-study-figures", "benchmarks/compensation_study.py", 3, shares=True),
    Page("diagnosis", "benchmarks/diagnosis.py", 13, ("benchmarks/verdicts/page.md",), SHARED, reads=True),
    Page(
        "eastman",
        "benchmarks/eastman.py",
        15,
        ("benchmarks/plant/worker.py", "benchmarks/tep-constraints.txt"),
        reads=True,
    ),
    Page("endurance", "benchmarks/endurance.py", 8, reads=True),
    Page("export", "benchmarks/export.py", 15, EXPORT, "make plc", reads=True, shares=True),
    Page("family", "benchmarks/family.py", 10),
    Page("ingredients", "benchmarks/ingredients.py", 15),
    Page("online", "benchmarks/online.py", 10, RIVALS, reads=True),
    Page("paper", "benchmarks/paper_tables.py", 2),
    Page("published-loops", "benchmarks/published.py", 15),
    Page("readme-examples", "benchmarks/readme_examples.py", 1, (REPORT,), SHARED, reads=True, shares=True),
    Page("records", "benchmarks/records.py", 30, (REMARKS,), reads=True, shares=True),
    Page("shared-data", "benchmarks/shared_data.py", 5, (REMARKS,), SHARED, reads=True),
    Page("speed", "benchmarks/speed.py", 6),
    Page("startup", "benchmarks/startup.py", 4, (COMMANDS,), reads=True),
    Page("stiction", "benchmarks/stiction.py", 5),
    Page("test-design", "benchmarks/design.py", 3),
    Page("wrong-inverse", "benchmarks/wrong_inverse.py", 6),
    Page("supervised", "benchmarks/supervised.py", 15, SUPERVISED, "make plc", reads=True, shares=True),
)
BY_HAND = {
    "audit": "what an audit does; figures with the command that repeats each",
    "compensation-study": "what the study simulates; its figures are quoted from compensation-study-figures",
    "equations": "the paper's equations and where they are in the code",
    "method": "how it works and what was tried; figures of the tries are of that time, others are quoted",
    "page": "what the page shows and refuses; tests/e2e/test_page*.py and benchmarks/page.py hold it to that",
    "live": "what the live link does and promises; tests/live and benchmarks/live.py hold it to that",
    "live-write": "how a block is asked for other widths; tests/live/test_write*.py and tests/e2e hold it to that",
    "live-security": "whom the live link believes; tests/opcua attacks it",
    "other-simulation": "how decisions fare in loops of others; figures with the command that repeats them",
    "security": "what is trusted and promised; tests/properties/test_hostile_*.py and benchmarks/hostile.py attack it",
    "reading": "what the readers repair and what they refuse; tests/e2e/test_corpus.py runs it",
}
