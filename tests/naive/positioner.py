"""Slow twins of ``kernels.positioner``, written from its text."""

import math


def command(u, delay, lag, line, parts):
    """The command behind a delay and a lag, `parts` values a sample."""

    def value(at):
        below = math.floor(at)
        here, after = (min(max(row, 0), len(u) - 1) for row in (below, below + 1))
        return u[here] + (at - below) * (u[after] - u[here]) if line else u[here]

    keep = math.exp(-1.0 / (lag * parts)) if lag > 1e-6 else 0.0
    state, found = u[0], []
    for k in range(len(u)):
        for part in range(1, parts + 1):
            at = k + part / parts - delay - (1.0 if line else 1e-9)
            state = keep * state + (1.0 - keep) * value(at)
            found.append(state)
    return found


def follow(v, y, half, offset, approach, rate, parts):
    """A play that approaches its target with a lag and a rate limit, from the first measured position on."""
    position, found = y[0], [y[0]]
    first = v[parts - 1] - offset
    target = min(max(position, first - half), first + half)
    for goal in (one - offset for one in v[parts:]):
        target = min(max(target, goal - half), goal + half)
        position += min(max(approach * (target - position), -rate), rate)
        found.append(position)
    return [found[0], *found[parts::parts]]


def holds(y, window):
    """Longest stretches from the left on whose range is within the window: first row, row behind, mean."""
    found, first = [], 0
    for row in range(1, len(y) + 1):
        if row == len(y) or max(y[first : row + 1]) - min(y[first : row + 1]) > window:
            found.append((first, row, sum(y[first:row]) / (row - first)))
            first = row
    return found
