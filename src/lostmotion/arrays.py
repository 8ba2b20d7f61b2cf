"""Array types, defined once."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
ComplexArray = npt.NDArray[np.complex128]
Reals = npt.NDArray[np.floating[Any]]  # of one type throughout, float64 or float32
