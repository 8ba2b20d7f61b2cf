"""Thresholds of the checks, each with its reason, in one place."""

from __future__ import annotations

SHORTEST = 30  # samples: fewer than about three per parameter of the smallest model
SHORT = 200  # samples: below this, intervals of a dead zone are rarely narrower than the dead zone itself
MISSING_SHARE = 0.05  # of rows: more, and the pieces between become short
FLAT_RUN = 5  # equal samples in a row: noise of a live transmitter does not repeat that often
FLAT_SHARE = 0.5  # of samples in such runs: the signal is held more than it is measured
LINEAR_RUN = 8  # samples on one straight line: chance and quantisation rarely line up so many
LINEAR_SHARE = 0.2  # of samples: more looks like interpolation between stored points
LINEAR_TOLERANCE = 1e-4  # of the standard deviation of the differences: rounding of stored decimals
REFRESH_ROWS = 1.8  # rows per change of OP or PV: the record is faster than the scan behind it
FROZEN_RUN = 20  # rows in which neither OP nor PV changes: a live loop with noise does not rest that long
FEW_LEVELS = 20  # distinct values: the resolution, not the process, then shapes the signal
COARSE_STEP = 0.05  # of the 5-95 % amplitude: a finer dead zone hides in one step
FINE_STEP = 1e-9  # of the range: smaller steps are rounding of floats, not resolution
SATURATED_RUN = 5  # samples at an extreme: a turning point lasts shorter
SATURATED_SHARE = 0.02  # of samples: below this, a limit does not bend the estimate
SPAN_MARGIN = 0.005  # of OP span: closer to a limit than this is at the limit
OUTSIDE_SHARE = 0.05  # of rows beyond the span: more are no stray values (`lostmotion.solve` stops there too)
FAR_OUTSIDE = 0.25  # of the span: a controller that winds up goes some percent beyond it, never so far
SMALL_RANGE = 0.2  # of the span: OP on both sides of a limit that moves no more has other units than its span
SMALL_AMPLITUDE = 0.02  # of OP span: valves in service have 1-2 % dead band, a smaller move cannot cross it
FEW_REVERSALS = 5  # of OP: lost motion shows only when OP turns round; fewer turns are anecdotes
REVERSAL_SIZE = 0.1  # of the 5-95 % amplitude: smaller turns are noise
MOVING_SHARE = 0.3  # of rows in which SP changes: a cascade's inner loop, not an operator
OUTLIER_Z = 12.0  # robust z of a jump that comes back at once: steps and noise do not do that
MANY_OUTLIERS = 0.001  # of samples: one in a thousand already moves a least-squares fit
AT_REST = 5  # rows of one value: a set point between two moves by hand, no ramp
FEWEST_THROUGH = 2  # steps of it through an odd value between: one may be a slip of the hand
THROUGH_SHARE = 0.25  # of the steps: of means over k scans 1 - 1/k go through a value, up to half of them a round one

# What prepare leaves out
BRIDGE_ROWS = 5  # missing rows: a cut there costs the initial states of process and noise, which are as many numbers
BRIDGE_SHARE = 0.2  # of rows: half of it is what intervals get too narrow; beyond, sizes moved by a standard error
CHANCE = 1e-3  # expected number of runs by chance above which a run proves nothing
SHORT_STILL = 8  # rows: shorter stand-stills are left to chance when its rate is estimated
JOIN_ROWS = 6  # moving rows between two frozen runs that belong to one halt of the recording
LIVE_SHARE = 0.5  # of rows in which a live OP moves; below, OP is moved in steps and long holds are its nature
HELD_OP_RUN = 60  # rows with one OP while PV moves: no controller with error in front of it holds so long
TEST_ROWS = 5  # rows between two holds of OP that belong to one test by hand
VISIBLE_NOISE = 0.25  # of moves that turn back at once: noise is visible, so PV cannot stand still by itself
PILE_UP = 4.0  # times as often at the extreme as at the three levels next to it together: clipped, not rare
OUTLIER_WINDOW = 3  # rows on either side that say what a sample should be
OUTLIER_SIZE = 8.0  # robust deviations from the median of the neighbours
OUTLIER_ROWS = 2  # a longer excursion is process, not a wild sample
OUTLIER_SHARE = 0.02  # of rows; more are no exceptions but the nature of the signal, and none is left out
SPLICE_SIZE = 25.0  # robust deviations that OP and PV both jump in one row, for good: two recordings
STRAIGHT_ROWS = 4  # samples on one exact line where the resolution is fine: never by chance
COARSE_ROWS = 7  # the same where lines are told only to a step
SHARP_BEND = 20.0  # steps by which a line misses its neighbour's continuation; rounding makes 12 of a smooth curve
FINE_RESOLUTION = 10.0  # steps in a typical move: then exact lines and stand-stills are the historian's
COMPRESSED_TOLD = 0.3  # of rows made up by the historian: worth telling
COMPRESSED_WARN = 0.6  # from here on, intervals are too narrow (docs/records.md)
COMPRESSED_REFUSE = 0.87  # break points wrong by many standard errors (docs/records.md)
ON_PHASE = 0.97  # of changes at one phase: the record repeats a slower scan
LONG_PIECES = (500, 330, 150)  # rows: all delays; all noise lags; all lags of the search for the dead zone
LONG_KEEP = 0.8  # of rows: shorter pieces go where the longer ones hold this share
DRIFT_SHARE = 0.5  # of variance slower than a quarter of the record
