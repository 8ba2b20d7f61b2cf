"""Rivals and plants live in environments of their own (``.venv-rivals``, ..); data go to and fro as .npz files."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from suite.experiment import Answers, Array, fresh

ROOT = Path(__file__).parent.parent.parent
PLACE = ROOT / ".venv-rivals"
CONSTRAINTS = ROOT / "benchmarks" / "rivals-constraints.txt"
WORKER = ROOT / "benchmarks" / "rivals" / "worker.py"
PACKAGES = ("padasip", "filterpy", "jax-sysid", "numpy", "scipy")
ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "JAX_PLATFORMS": "cpu",
}


def settings() -> dict[str, str]:
    """Environment variables of the rivals: one thread, and nothing of this interpreter's."""
    return {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")} | ONE_THREAD


def python() -> Path:
    """Interpreter of the rivals."""
    return interpreter(PLACE, CONSTRAINTS, PACKAGES, "the rivals")


def interpreter(place: Path, constraints: Path, packages: tuple[str, ...], what: str) -> Path:
    """Interpreter of the environment `place`; installs it where it is not there yet or its pins have changed."""
    found, stamp = place / "bin" / "python", place / ".installed"
    pins = constraints.read_text(encoding="utf-8")
    if stamp.exists() and stamp.read_text(encoding="utf-8") == pins:
        return found
    print(f"installing {what} into {place.name} (once, about a minute)", flush=True)
    subprocess.run([sys.executable, "-m", "venv", "--clear", str(place)], check=True)
    install = [str(found), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*install, "-c", str(constraints), *packages], check=True, env=settings())
    stamp.write_text(pins, encoding="utf-8")
    return found


def work(name: str, records: list[tuple[Array, Array]]) -> dict[str, Array]:
    """Results of the worker for one rival."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "in.npz", Path(folder) / "out.npz"
        u, y = (np.array(column) for column in zip(*records, strict=True))
        np.savez(source, u=u, y=y, fresh=fresh()[0])
        subprocess.run([str(python()), str(WORKER), name, str(source), str(target)], check=True, env=settings())
        with np.load(target) as result:
            return dict(result)


def answers(name: str, records: list[tuple[Array, Array]]) -> Answers:
    """What a rival made of the records."""
    return Answers(**work(name, records))


def yardstick(records: list[tuple[Array, Array]]) -> float:
    """Median seconds of one bare step of padasip's RLS with 9 weights."""
    return float(np.median(work("yardstick", records)["seconds"]))
