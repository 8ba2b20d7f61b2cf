"""Commands that need no extra, and those that name the one that they lack."""

import numpy as np

from lostmotion.files import write_columns
from lostmotion.simulate import routine_operation

NAMED = 'pip install "lostmotion[{}]"'
WORK = {
    "check": ("check", "{loop}"),
    "diagnose": ("diagnose", "{loop}", "--out", "diagnosis.json", "--report", "report.html"),
    "compensate": ("compensate", "{loop}", "--fit", "{fit}", "--out", "compensated.csv"),
    "simulate": ("simulate", "{fit}", "--kp", "0.4", "--ki", "0.1", "--sp-step", "1", "--op-span", "-10", "10"),
    "design": ("design", "--fit", "{fit}", "--op-limits", "-5", "5", "--duration", "60", "--out", "test.csv"),
    "export": ("export", "{fit}", "--name", "LY_101", "--date", "2026-01-31", "--span", "-10", "10", "--out", "block"),
    "online": ("online", "-", "--orders", "3,2,3"),
    "solve": ("solve", "{loop}", "--out", "block.json"),
    "demo": ("demo", "demo"),
    "demo-plant": ("demo-plant", "plant", "--loops", "2", "--days", "0.05", "--faults", "1", "--format", "csv"),
    "warm-up": ("warm-up", "--help"),
    "request": ("request", "--help"),
    "paper": ("paper", "--help"),
}
LACKING = {
    "audit": ("audit", ("audit", "{folder}")),
    "show": ("audit", ("audit", "--show", "plant.db")),
    "serve": ("web", ("serve", "--no-open", "--port", "0")),
    "live": ("live", ("live", "opc.tcp://127.0.0.1:1", "--op", "a", "--pv", "b", "--orders", "1,0,1", "--dt", "1")),
    "discover": ("live", ("live", "--discover", "opc.tcp://127.0.0.1:1", "--insecure")),
    "demo-live": ("live", ("demo-live", "--port", "0", "--seconds", "0")),
    "figure": ("plot", ("identify", "{loop}", "--nonlinearity", "none", "--figure", "a.png")),
    "database": ("sql", ("check", "postgresql://reader@127.0.0.1:1/plant", "--query", "SELECT 1")),
    "cluster": ("audit", ("audit", "{folder}", "--engine", "dask")),
}  # fmt: skip


def record(place):
    """File of a level tank in routine operation, alone in a folder."""
    made = routine_operation(1500, drift="mild", seed=7)
    columns = {"time_s": made.time, "SP": made.reference, "PV": made.measured, "OP": made.command}
    (place / "records").mkdir()
    return write_columns(
        place / "records" / "LIC-101.csv", {name: np.round(values, 5) for name, values in columns.items()}
    )


def assert_needs_none(done):
    assert done.returncode in (0, 1), done.stderr
    assert "No module" not in done.stderr
    assert "pip install" not in done.stderr
    assert done.stdout


def assert_names(extra, done):
    assert done.returncode in (1, 2), done.stderr
    assert NAMED.format(extra) in done.stderr
    assert "No module" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
