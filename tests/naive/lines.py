import math


def knots(values, tolerance):
    """Knots of the lines: each line tried anew from its start, every slope condition checked each time."""
    found, start, n = [0], 0, len(values)

    def passes(stop):
        moves = [(k - start, values[k] - values[start]) for k in range(start + 1, stop + 1)]
        bounds = [((move - tolerance) / rows, (move + tolerance) / rows) for rows, move in moves]
        if any(math.isnan(bound) for pair in bounds for bound in pair):
            return False
        return max(low for low, _ in bounds) <= min(high for _, high in bounds)

    while start < n - 1:
        stop = start + 1
        if passes(stop):
            while stop + 1 < n and passes(stop + 1):
                stop += 1
        start = stop
        found.append(start)
    return found
