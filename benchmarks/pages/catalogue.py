"""Every page of ``docs/``, and who writes it."""

from __future__ import annotations

from dataclasses import dataclass

SHARED = "the real records in ../shared/data"


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
    needs : str
        What must be there before.
    shares : bool
        Whether its script may run beside another: it keeps to one core, and its page holds no times.
    """

    name: str
    script: str
    minutes: float
    needs: str = ""
    shares: bool = False

    @property
    def file(self) -> str:
        """The page, relative to the repository."""
        return f"docs/{self.name}.md"


PAGES = (
    Page("accuracy", "benchmarks/accuracy.py", 5),
    Page("adaptive", "benchmarks/adaptive.py", 15, shares=True),
    Page("blocks", "benchmarks/blocks.py", 6),
    Page("clean-bill", "benchmarks/clean_bill.py", 6),
    Page(
        "commissioning-example",
        "examples/virtual_commissioning.py",
        1,
        needs="make plc",
        shares=True,
    ),
    Page("compensation", "benchmarks/compensation.py", 2, shares=True),
    Page("compensation-study-figures", "benchmarks/compensation_study.py", 3, shares=True),
    Page("diagnosis", "benchmarks/diagnosis.py", 13, needs=SHARED),
    Page(
        "eastman",
        "benchmarks/eastman.py",
        15,
    ),
    Page("endurance", "benchmarks/endurance.py", 8),
    Page("export", "benchmarks/export.py", 15, needs="make plc", shares=True),
    Page("family", "benchmarks/family.py", 10),
    Page("ingredients", "benchmarks/ingredients.py", 15),
    Page("online", "benchmarks/online.py", 10),
    Page("paper", "benchmarks/paper_tables.py", 2),
    Page("published-loops", "benchmarks/published.py", 15),
    Page("readme-examples", "benchmarks/readme_examples.py", 1, needs=SHARED, shares=True),
    Page("records", "benchmarks/records.py", 30, shares=True),
    Page("shared-data", "benchmarks/shared_data.py", 5, needs=SHARED),
    Page("speed", "benchmarks/speed.py", 6),
    Page("startup", "benchmarks/startup.py", 4),
    Page("stiction", "benchmarks/stiction.py", 5),
    Page("test-design", "benchmarks/design.py", 3),
    Page("wrong-inverse", "benchmarks/wrong_inverse.py", 6),
    Page("supervised", "benchmarks/supervised.py", 15, needs="make plc", shares=True),
)
BY_HAND = {
    "actuator": "what the measured position shows; benchmarks/positioners.py scores it",
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
