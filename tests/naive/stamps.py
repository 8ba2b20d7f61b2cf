"""Rows on a clock, one rule after the other."""

import math


def count_samples(stamps, dt, wrap=0.0, last=math.nan, phase=0.0, base=0.0, early=False):
    """Counts and times of the rows, and (last, phase, base, early) after them."""
    counts, times = [], []
    for stamp in stamps:
        time = last + dt if math.isnan(stamp) else stamp + base
        if wrap and not math.isnan(stamp) and time < last - wrap / 2:
            base, time = base + wrap, time + wrap
        count = 1
        if math.isnan(time):
            count = 0
        elif not math.isnan(last):
            step = time - last
            passed = step / dt + phase
            if step < -7200 or step > 3.2e7:
                count, phase = -1, 0.0
            elif step <= 0:
                count = 0
            elif passed < 0.5:
                count, early = 0, True
            else:
                count = math.floor(passed + 0.5)
                phase = passed - count if early else 0.9 * (passed - count)
        if count:
            last, early = time, False
        counts.append(count)
        times.append(time)
    return counts, times, (last, phase, base, early)
