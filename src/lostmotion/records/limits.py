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
SMALL_AMPLITUDE = 0.02  # of OP span: valves in service have 1-2 % dead band, a smaller move cannot cross it
FEW_REVERSALS = 5  # of OP: lost motion shows only when OP turns round; fewer turns are anecdotes
REVERSAL_SIZE = 0.1  # of the 5-95 % amplitude: smaller turns are noise
MOVING_SHARE = 0.3  # of rows in which SP changes: a cascade's inner loop, not an operator
OUTLIER_Z = 12.0  # robust z of a jump that comes back at once: steps and noise do not do that
MANY_OUTLIERS = 0.001  # of samples: one in a thousand already moves a least-squares fit
