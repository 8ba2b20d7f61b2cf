"""The page that benchmarks/online.py writes."""

from __future__ import annotations

PAGE = """# Online estimation beside its rivals

Made by `.venv/bin/python benchmarks/online.py` in {minutes:.0f} minutes ({machine}), all in one run. Paper's level
tank, dead zone +-1, PRS -5 .. 5 held for 10 samples, white noise of variance {variance}, 20,000 samples; every method
gets the same records and is told the orders and the delay. The rivals run in an environment of their own, each as well
tuned as trying on these data made it (`benchmarks/rivals/`: one file each, which says what was tried).

| method | also told | converged | RMSE / bound | fit % (worst) | daily conv. | daily error | per sample | RLS steps |
|---|---|---|---|---|---|---|---|---|
{rows}

Converged: break points and slope ratio within 0.3 of the truth. RMSE / bound: left / right / slope ratio over the
converged seeds; from 100 seeds a RMSE is uncertain by 7 %, from 20 by 16 %, from 8 by 25 %. The bound is the
Cramer-Rao bound of who knows that the offset is 0, {limit}; for who must find the offset it is
{wider} times larger. Fit: simulated from u alone on fresh data without noise, median over the seeds.

Daily: the same tank in routine operation (`lm.routine_operation`: PI loop, set-point moves, mild drift, no test
signal), 6,000 samples; median error of the break points over all seeds, in % of the half-width. The test signal with
white noise is kind to a model without noise dynamics and to a local search, daily data are not.

Per sample: processor time of the whole record divided by its samples, for the batch methods too, although these
start again with every new sample; that of RecursiveML holds the batch fit of its first 1,000 samples, without it see
below. RLS steps: the same in steps of padasip's RLS with 9 prepared regressors ({yardstick:.1f} us in this run).

Start: RecursiveIV, RecursiveML and `identify` find their own. The rivals that need one get a first-order lag behind a
dead zone of half the true width.

## Speed

`run` over 10^6 samples, start included, every 1,000th estimate kept, one thread, processor time, fastest of 7; "RLS /
this" is the ratio to padasip's RLS. `update(u, y)`: called from Python, median of 50,000. Operations are counted by
running the kernels on numbers that count. A plain compiled y += a x reaches {peak:.1f} Gflop/s on the same core.

| estimator | `run`, per sample | RLS / this | `update` | operations per sample | Gflop/s | of the plain loop |
|---|---|---|---|---|---|---|
{speed}

`lostmotion online` takes {command:.1f} s for a CSV of 10^6 rows, state file and start of the interpreter included.
{many}{bar}"""

MANY = """
## Many loops

`run_many`, 1,000 loops of 10,000 samples, wall time, fastest of 7 by turns. The first row is what two threads without
anything in common gain on this machine in the same run. `RecursiveML` begins with a batch fit, which is Python, and
runs in processes; `RecursiveIV` in threads.

| estimator | one worker | per sample | two workers | times faster |
|---|---|---|---|---|
{rows}
"""

BARS = """
## RecursiveML against the bound

100 seeds each; left / right / slope ratio. The estimator finds the offset and reports zero for it where the
information criterion prefers that, so the fair bound lies between the two.

| samples | converged | RMSE / bound, offset free | RMSE / bound, offset known to be 0 | coverage of 95 % intervals, % |
|---|---|---|---|---|
{rows}

False events in daily records (6,000 samples each, nothing changes): {short}; when it starts from 2,000 samples
instead of 1,000: {long}.
"""

ASSUMPTIONS = """
## Where an assumption does not hold

`RecursiveML` on the same experiment, 20,000 samples, {seeds} seeds. Errors of left and right, coverage of their 95 %
intervals in %, events in all seeds (nothing changes), and the status at the end. Slow drift: docs/adaptive.md.

| what is wrong | error, median | largest | standard error | coverage | events | status |
|---|---|---|---|---|---|---|
{rows}
"""
