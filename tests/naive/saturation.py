"""Saturation by sorting: the middle one of u and the two limits."""


def saturation(u, low, high):
    return [sorted([low, value, high])[1] for value in u]
