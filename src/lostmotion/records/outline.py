"""Few rows of a long signal that show it as all would."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray


def outline(values: FloatArray, most: int) -> npt.NDArray[np.intp]:
    """Rows with the lowest and the highest value of every short stretch, in order; all where there are no more.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where nothing is known.
    most : int
        Rows, at most; even.

    Examples
    --------
    >>> outline(np.array([0.0, 5.0, 1.0, 1.0, -3.0, 2.0, 2.0, 2.0]), 4).tolist()
    [0, 1, 4, 5]
    """
    if values.size <= most:
        return np.arange(values.size)
    width = -(-values.size // (most // 2))
    whole = -(-values.size // width) * width
    padded = np.append(values, np.full(whole - values.size, np.nan))
    blocks = padded.reshape(-1, width)
    low = np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high = np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    inside = np.sort(np.column_stack([low, high]), axis=1) + width * np.arange(len(blocks))[:, None]
    return inside.ravel()
