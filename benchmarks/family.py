"""``identify`` with everything "auto" on random loops whose truth is known.

Run: ``.venv/bin/python benchmarks/family.py`` (500 loops, about 10 minutes in one process); writes docs/family.md.
Options: ``--cases N`` and ``--seed S`` for another run, which writes no page; ``--workers N``; ``--json FILE``.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

from lostmotion.evaluate import MonteCarloResult, monte_carlo
from lostmotion.report.monte_carlo_text import HEAD, cells
from pages import publish

OUTPUT = Path(__file__).parent.parent / "docs" / "family.md"
EVERY = 25


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=None)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--json", type=Path, default=None)
    arguments = parser.parse_args()
    result = monte_carlo("large", seed=arguments.seed, workers=arguments.workers, cases=arguments.cases, progress=tell)
    print(result.summary())
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(result.to_dict(), allow_nan=False), encoding="utf-8")
    if arguments.cases is None and arguments.seed == 0:
        publish(OUTPUT, page(result))


def tell(done: int, total: int) -> None:
    if done % EVERY == 0 or done == total:
        print(f"{done} of {total}", flush=True)


def page(result: MonteCarloResult) -> str:
    rows = [line(cells(group, figures)) for group, figures in result.scores.items() if figures["cases"]]
    head = line(HEAD) + "\n" + line(["---"] * len(HEAD))
    counts = {known: Counter(c.status for c in result.cases if c.identifiable is known) for known in (True, False)}
    names = sorted({case.status for case in result.cases})
    statuses = [line([name, str(counts[True][name]), str(counts[False][name])]) for name in names]
    delays = [case for case in result.cases if case.identifiable and case.delay_found is not None]
    apart = Counter(min(abs(case.delay_found - case.delay), 4) for case in delays)
    told = ", ".join(f"{'4 or more' if far == 4 else far}: {apart[far]}" for far in range(5))
    return PAGE.format(head=head, rows="\n".join(rows), statuses="\n".join(statuses), delays=told, n=len(result.cases))


def line(row) -> str:
    return "| " + " | ".join(row) + " |"


PAGE = """# `identify` on a family of random loops

Made by `.venv/bin/python benchmarks/family.py`: {n} loops, everything "auto", one record of 3,000 samples each. The
same from Python, for any estimator that returns an object with the names of `HammersteinFit`:

```python
from lostmotion import evaluate

result = evaluate.monte_carlo("large", estimator=None, seed=0)
print(result.summary())
result.table  # one row for each loop; evaluate.random_loop(index, seed) makes its record again
```

The family:

- process: 1 to 3 poles, real, a complex pair (damping 0.25 to 0.9) or one integrator; dominant time constant 5 to 50
  samples; a quarter of orders 2 and 3 with a zero (leading or inverse response); gain of either sign;
- delay: 0 to 15 samples in open loop, 1 to 15 in closed loop (1 is a held input without dead time);
- dead zone: width 5 to 60 % of the range of OP, off its middle, slope ratio 0.3 to 3;
- units: half with OP near 50 % and an offset of PV, half in deviations;
- noise at the output: half white, half AR(1) or AR(2), variance 5 to 30 dB below that of the noise-free PV;
- open loop (half): random staircase, each level held for 0.2 to 1 dominant time constants; for integrators one that
  turns back where PV runs away;
- closed loop (half): PI by Skogestad's rules for a largest sensitivity of 1.3 to 1.8, set-point moves every 2 to 5
  settling times; the noise is the disturbance too.

No record begins at rest. Every loop carries the standard errors that its record allows (Cramer-Rao bound from the
true model, with orders and noise order known). Where both break points' expected 95 % intervals are narrower than a
third of the width the loop counts as identifiable.

{head}
{rows}

In %, but for counts, bias, efficiency and CPU seconds (median/worst). Of the identifiable loops:

- *success*: both break points within 3 expected standard errors and a status that says they can be used;
- *within*: whatever the status; *cover*: reported 95 % intervals that hold the truth;
- *delay*: exact; *told*: exact, of those (their number in brackets) whose record tells the delay at all: models of the
  true orders with one sample more or less fit the noise-free PV worse by 25 in twice the log-likelihood;
- *bias*, *eff.*: mean and root mean square of the error in expected standard errors, of the loops within.

Of the others, *honest*: refused, or both reported intervals hold the truth.

Errors of the delay in samples, identifiable loops: {delays}.

| status | identifiable | not identifiable |
|---|---|---|
{statuses}
"""


if __name__ == "__main__":
    main()
