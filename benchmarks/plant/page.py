"""The page that benchmarks/eastman.py writes."""

from __future__ import annotations

PAGE = """# Tennessee Eastman plant with sticking valves

Made by `.venv/bin/python benchmarks/eastman.py` in {minutes:.0f} minutes ({machine}, one thread). The plant is
`tep-studio` 0.2.0 from PyPI, which compiles the revised C code of Bathelt, Ricker and Jelali (2015) of the problem of
Downs and Vogel (1993), in an environment of its own (`.venv-tep`); it runs under its own decentralised PI control
(Ricker 1996, mode 1). A run is {hours:g} h after one hour of start, plant and controllers step every 1.8 s, and so do
the records ({rows:,} rows). Each of the 9 loops that drive a valve is given to `lm.diagnose` as OP, PV and SP, nothing
else. PV and SP are those of the controller that drives the valve, the inner one of a cascade.

## What sticks, and what the true gap is

IDV(14): reactor cooling water valve. IDV(15): condenser cooling water valve. IDV(19): valves of separator underflow
and stripper underflow, and the recycle and steam valves, which stand still in this control scheme. In the code

    if abs(taken over - command) > 2 %: taken over = command
    stem follows what was taken over with a lag of 5 s

so that the valve rests, then jumps all the way to the command and rests again at once. The **true gap**, the largest
distance between command and what the valve took over, is 2 % of its range (measured below from the stem positions,
with the lag inverted). In the words of `lm.Stiction` this is `Stiction(band=2, jump=2, model="he")` exactly (last
table, column "differs"): the slip is as large as the band, so band = gap = 2 %. The command may move over 4 % in all,
2 % to either side of the valve, without moving it; a backlash of width 4 would have the same gap.

## Score

A sticking valve is found where the verdict is stiction or backlash; "by likelihood" is the kind of the fit alone;
"within 25 %": it is one of these two and its band (or width) is 1.5 .. 2.5 %. Five runs with different measurement
noise; sizes in the order of the runs, or the kind where it is another.

| run | loop | found | by likelihood | within 25 % | sizes |
|---|---|---|---|---|---|
{scores}

The last two lines: loops whose valve does not stick, verdicts that name a fault of the valve ("found"), and fits of a
kind other than none.

<!-- words by hand -->

## All loops, first seed

Gap: (band + jump) / 2 of the valve found, where it breaks away; of a backlash, half its width.
Seconds of processor time.

| run | loop | true gap | verdict | kind | size, % (95 %) | / true gap | gap | s |
|---|---|---|---|---|---|---|---|---|
{every}

## Loops with a sticking valve, other seeds

| run | loop | seed | verdict | kind | size, % (95 %) | / true gap | gap | s |
|---|---|---|---|---|---|---|---|---|
{seeds}

## The same records sampled more slowly

Every third, fifth and tenth row of the first seed's records.

| run | loop | dt, s | verdict | kind | size, % (95 %) | / true gap | gap | s |
|---|---|---|---|---|---|---|---|---|
{sampling}

## What the likelihood says at the truth

Gain in log-likelihood over a linear model without lost motion when PV is explained by a valve that is told:
`Stiction(d, d, model="he")` with five d, and Kano's form of the true one. Differs: largest distance between the first
of them with d = 2 and what the plant's valve really took over.

| run | loop | differs | 1.9 | 1.98 | 2 | 2.02 | 2.1 | 2, Kano |
|---|---|---|---|---|---|---|---|---|
{truth}
"""
