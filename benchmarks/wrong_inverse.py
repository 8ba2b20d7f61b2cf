"""Does a loop with backlash or stiction ever get a block against a dead zone?

Run: ``.venv/bin/python benchmarks/wrong_inverse.py`` (about 6 minutes on two cores); writes docs/wrong-inverse.md and
prints wrong blocks. A shorter run (``--first``, ``--second``, ``--physical``) prints only.

Each loop goes to a block and its code as a newcomer does it: ``identify`` with the record and nothing else, ``block``,
``export``. Then once more with ``nonlinearity="dead zone"`` asked for, which only the status can stop.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
from collections import Counter  # noqa: E402
from collections.abc import Callable, Sequence  # noqa: E402
from dataclasses import dataclass  # noqa: E402
from pathlib import Path  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate import random_faulty_loop  # noqa: E402
from lostmotion.evaluate.random_faults import CAUSES, FaultyLoop  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from lostmotion.export import export  # noqa: E402
from pages import publish  # noqa: E402
from verdicts.physical_valve import physical_loop  # noqa: E402
from verdicts.second_family import CELLS, second_family  # noqa: E402

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "wrong-inverse.md"
KINDS = ("backlash", "stiction")
LOOPS = (80, 80, 40)  # of each family
SEEDS = 61_000
STRIDE = 37  # of the cells of the second family: prime to its size, so every process and load comes up
WRONG = "dead zone"
ASKED = ("auto", "dead zone")


@dataclass(frozen=True)
class Way:
    """How far one loop came.

    Attributes
    ----------
    loop : str
        Family and seed.
    kind : str
        True kind.
    end : str
        "refused: STATUS", or the kind that the exported block is for.
    said : str
        Kind, status and numbers of the fit.
    """

    loop: str
    kind: str
    end: str
    said: str


def first(seed: int) -> tuple[Way, ...]:
    """A loop of the first family, every second pair rough."""
    return ways("first", seed, random_faulty_loop(seed, cause=KINDS[seed % 2], rough=bool(seed // 2 % 2)))


def second(seed: int) -> tuple[Way, ...]:
    """A loop of the second family."""
    cell = seed * STRIDE % (CELLS // len(CAUSES)) * len(CAUSES) + CAUSES.index(KINDS[seed % 2])
    return ways("second", cell, second_family(cell))


def physical(seed: int) -> tuple[Way, ...]:
    """A loop with a valve of mass and friction, and a process that is not linear."""
    return ways("physical", seed, physical_loop(seed, KINDS[seed % 2]))


def ways(family: str, seed: int, loop: FaultyLoop) -> tuple[Way, ...]:
    """Without options, and with a dead zone asked for."""
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    return tuple(way(f"{family} {seed}", loop.cause, record, asked) for asked in ASKED)


def way(name: str, kind: str, record: lm.LoopRecord, asked: str) -> Way:
    """From the record to code in the plant's language, as far as it goes."""
    try:
        fit = lm.identify(record) if asked == "auto" else lm.identify(record, nonlinearity=asked)
    except lm.InputError as error:
        return Way(name, kind, "refused: record", str(error))
    said = f"{fit.kind.name} {fit.status.name} {fit.parameters}"
    if fit.kinds is not None:
        said += f" {fit.kinds.best} {fit.kinds.confidence:.2f}, then {fit.kinds.runner_up}"
    try:
        block = fit.block()
        export(block, "st", name="FY_1", date="2026-01-31", fit=fit)
    except lm.GateError:
        return Way(name, kind, f"refused: {fit.status.name if not fit.status.ok else 'OK, but not sure enough'}", said)
    except lm.InputError as error:
        return Way(name, kind, "refused: no block", f"{said} {error}")
    return Way(name, kind, block.specification.fault, said)


def table(found: Sequence[Sequence[Way]], number: int) -> list[str]:
    """Ends of all loops by true kind; `number` of the way."""
    ends = Counter((one[number].kind, one[number].end) for one in found)
    names = sorted({end for _, end in ends}, key=lambda end: (end.startswith("refused"), end))
    rows = [f"| {end} | " + " | ".join(str(ends[kind, end]) for kind in KINDS) + " |" for end in names]
    total = " | ".join(str(sum(one[number].kind == kind for one in found)) for kind in KINDS)
    return ["| end of the way | backlash | stiction |", "|---|---|---|", *rows, f"| all | {total} |"]


def wrong(found: Sequence[Sequence[Way]], number: int) -> list[Way]:
    """Blocks against a dead zone in a valve that has none."""
    return [one[number] for one in found if one[number].end == WRONG]


def page(everything: Sequence[Sequence[Way]]) -> str:
    """Both ways as tables."""
    lines = [
        "# Does a valve that sticks ever get the inverse of a dead zone?",
        "",
        "Made by `.venv/bin/python benchmarks/wrong_inverse.py`.",
        "",
        f"{len(everything)} simulated loops of 2,000 samples with backlash or stiction ({LOOPS[0]} and {LOOPS[1]} of "
        f"the two families of [diagnosis.md](diagnosis.md), {LOOPS[2]} with a valve of mass and friction and a process "
        "that is not linear) go to a block and its code as a newcomer does it: `lm.identify(record)`, `fit.block()`, "
        'export; then once more with `nonlinearity="dead zone"` asked for. `accept=` is not given. A block against a '
        "dead zone would be the wrong inverse; none is the bar.",
    ]
    for number, asked in enumerate(ASKED):
        lines += ["", f'## nonlinearity="{asked}"', "", *table(everything, number)]
        lines += ["", f"Blocks against a dead zone: {len(wrong(everything, number))}."]
    return "\n".join([*lines, ""])


def main() -> int:
    """Measure and print; 1 where one block is against a dead zone."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=LOOPS[0])
    parser.add_argument("--second", type=int, default=LOOPS[1])
    parser.add_argument("--physical", type=int, default=LOOPS[2])
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args()
    families: tuple[tuple[str, Callable[[int], tuple[Way, ...]], int], ...] = (
        ("first family", first, given.first),
        ("second family", second, given.second),
        ("valves of mass and friction", physical, given.physical),
    )
    everything: list[tuple[Way, ...]] = []
    for name, work, number in families:
        everything += run_all(work, range(SEEDS, SEEDS + number), name, given.workers)
    text = page(everything)
    print(text)
    for number in range(len(ASKED)):
        for one in wrong(everything, number):
            print(f"WRONG {one.loop}, {one.kind}: {one.said}")
    if (given.first, given.second, given.physical) == LOOPS:
        publish(OUTPUT, text)
    return int(any(wrong(everything, number) for number in range(len(ASKED))))


if __name__ == "__main__":
    raise SystemExit(main())
