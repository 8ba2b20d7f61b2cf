"""Floating-point operations of one sample, counted: the kernels run as plain Python on numbers that count.

Run as a script with NUMBA_DISABLE_JIT=1: ``operations.py NAME IN.npz OUT.npz``; IN holds the saved state of an
estimator and the next samples. Additions, multiplications, divisions, roots and exponentials count 1 each;
comparisons, moves and index arithmetic nothing. Places that only pad a vector register count too.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm


class Counted(float):
    """A float whose arithmetic is counted in ``Counted.total``."""

    total = 0

    @classmethod
    def once(cls, value: Any) -> Any:
        cls.total += 1
        return value if value is NotImplemented else cls(value)

    def __neg__(self) -> Counted:
        return Counted(float.__neg__(self))

    def __abs__(self) -> Counted:
        return Counted(float.__abs__(self))


def _counting(name: str) -> Any:
    plain = getattr(float, name)

    def operation(self: Counted, other: Any) -> Any:
        return Counted.once(plain(self, float(other)))

    return operation


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv"):
    setattr(Counted, f"__{_name}__", _counting(f"__{_name}__"))


def counted(values: np.ndarray) -> np.ndarray:
    """The same array with numbers that count."""
    result = np.empty(values.shape, dtype=object)
    for index, value in np.ndenumerate(values):
        result[index] = Counted(value)
    return result


class CountingLinalg:
    """The one routine of LAPACK that a kernel calls, at its textbook count of 9 n^3 (Golub and Van Loan, 8.3)."""

    @staticmethod
    def eigh(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        Counted.total += 9 * len(matrix) ** 3
        values, vectors = np.linalg.eigh(matrix.astype(np.float64))
        return counted(values), counted(vectors)


class CountingNumpy:
    """NumPy as the kernels see it here: new arrays hold numbers that count, functions of one number count."""

    linalg = CountingLinalg

    def __getattr__(self, name: str) -> Any:
        return getattr(np, name)

    @staticmethod
    def zeros(shape: Any) -> np.ndarray:
        return counted(np.zeros(shape))

    empty = zeros

    @staticmethod
    def full(shape: Any, value: Any) -> np.ndarray:
        return counted(np.full(shape, float(value)))

    @staticmethod
    def sqrt(value: float) -> Counted:
        return Counted.once(np.sqrt(float(value)))

    @staticmethod
    def exp(value: float) -> Counted:
        return Counted.once(np.exp(float(value)))


def count(name: str, saved: bytes, u: np.ndarray, y: np.ndarray) -> float:
    """Operations a sample of ``update``."""
    estimator = getattr(lm, name).from_bytes(saved)
    for module_name, module in sys.modules.items():
        if module_name.startswith("lostmotion.kernels.") and hasattr(module, "np"):
            module.np = CountingNumpy()
    if name == "RecursiveML":
        recursion = estimator._recursion
        recursion.state, recursion._psi = counted(recursion.state), counted(recursion._psi)
    else:
        estimator._state = counted(estimator._state)
    Counted.total = 0
    for pair in zip(u.tolist(), y.tolist(), strict=True):
        estimator.update(*map(Counted, pair))
    return Counted.total / u.size


def operations(estimator: Any, u: np.ndarray, y: np.ndarray) -> float:
    """Count in a process without the JIT, from the state of `estimator` on."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "in.npz", Path(folder) / "out.npz"
        np.savez(source, saved=np.frombuffer(estimator.to_bytes(), dtype=np.uint8), u=u, y=y)
        command = [sys.executable, __file__, type(estimator).__name__, str(source), str(target)]
        subprocess.run(command, check=True, env=os.environ | {"NUMBA_DISABLE_JIT": "1"})
        with np.load(target) as result:
            return float(result["operations"])


if __name__ == "__main__":
    with np.load(sys.argv[2]) as data:
        total = count(sys.argv[1], data["saved"].tobytes(), data["u"], data["y"])
    np.savez(sys.argv[3], operations=total)
