"""``lm.audit``: one call from the data of a plant to what is wrong with which loop."""

from __future__ import annotations

import os
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from lostmotion.audit.audit_run import AuditRun
from lostmotion.audit.runner.engine.choice import open_engine
from lostmotion.audit.runner.run import Report, run_audit
from lostmotion.audit.settings import LOOP_MINUTES, AuditSettings
from lostmotion.diagnose.op_span import TOLERANCE
from lostmotion.errors import ParameterError
from lostmotion.plant.open_plant import open_plant
from lostmotion.records.when import as_moment, seconds_in
from lostmotion.store.store import Store


def audit(
    source: Any,
    store: str | os.PathLike[str] = "plant.db",
    *,
    engine: str = "processes",
    workers: int | None = None,
    loops: Any = None,
    window: float | str | None = None,
    since: Any = None,
    until: Any = None,
    tolerance: float = TOLERANCE,
    cpu_minutes: float | None = None,
    loop_minutes: float | None = LOOP_MINUTES,
    screen_only: bool = False,
    insecure: bool = False,
    progress: Report | None = None,
    **reading: Any,
) -> AuditRun:
    """Look at all loops of a plant: screen each, diagnose what is worth it, rank, group; keep it in a store.

    An audit that was stopped or killed goes on where it was, and what has not changed since an earlier one is not done
    again. All loops are screened before any is diagnosed, and those come first whose diagnosis is worth most.

    Parameters
    ----------
    source : path, list of paths, data frame, list of records or mapping of tags to them, or URL of a database
        A folder, a pattern, files with one loop or many, Parquet in pieces (:func:`lostmotion.plant.open_plant`).
    store : path or URL
        An SQLite file, made if it is not there, or ``postgresql://..``. It may lie in no folder of a network.
    engine : str
        "processes" of this machine, "inline", "dask", or the address of a Dask scheduler.
    workers : int, optional
        None: one a processor.
    loops : path or sequence of PlantLoop, optional
        Loop list. None: what can be inferred from names and data.
    window : float or str, optional
        Length of an assessment in seconds, or as "2h". None: all that the source has of a loop.
    since, until : date, optional
        ISO text or datetime; without a time zone in UTC.
    tolerance : float
        Lost motion that does not matter, as a share of the span of OP.
    cpu_minutes : float, optional
        Processor time of the diagnoses together. None: no limit.
    loop_minutes : float, optional
        On the clock, for one loop in one window: what takes longer is a failure of that loop. None: no limit.
    screen_only : bool
        Nothing is diagnosed.
    insecure : bool
        Allow a scheduler on another machine without encryption.
    progress : callable, optional
        Given a :class:`lostmotion.audit.runner.run.Progress` now and then.
    **reading
        As for :func:`lostmotion.read_loop`: dt, op_span, uncertain, automatic ..

    Returns
    -------
    AuditRun

    Raises
    ------
    LostMotionError
        The source holds no loops or two of one tag, the loop list is wrong, the store cannot be written, another audit
        is at work in it, or no worker is left. What goes wrong with one loop is a row of the result.

    Examples
    --------
    >>> import tempfile
    >>> from lostmotion.evaluate import random_faulty_loop
    >>> from lostmotion.records import LoopRecord
    >>> loop = random_faulty_loop(4, cause="stiction", process="flow")
    >>> record = LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0, op_span=(0.0, 100.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = audit({"FIC-101": record}, f"{folder}/plant.db", engine="inline", screen_only=True)
    >>> [(row.tag, row.verdict, row.reason) for row in found.rows]
    [('FIC-101', 'cannot tell', 'swings regularly')]
    """
    settings = AuditSettings(
        tolerance, _seconds(window), _moment(since), _moment(until), screen_only=screen_only, cpu_minutes=cpu_minutes,
        loop_minutes=_limit(loop_minutes),
    )  # fmt: skip
    plant = open_plant(source, loops, **reading)
    with Store(store) as opened, closing(open_engine(engine, workers, insecure=insecure)) as chosen:
        number = run_audit(plant, opened, settings, chosen, progress, name=_name(source))
    return AuditRun.of(store, number)


def _seconds(window: float | str | None) -> float | None:
    seconds = seconds_in(window) if isinstance(window, str) else window
    if window is not None and (seconds is None or not 1.0 <= seconds < 1e9):
        raise ParameterError.expected("a window of a second and more", repr(window), 'e.g. "2h", "1d" or 3600')
    return seconds


def _limit(minutes: float | None) -> float | None:
    if minutes is not None and not 0.0 < minutes < 1e6:
        raise ParameterError.expected("loop_minutes > 0", minutes, "30 are plenty; None sets no limit")
    return minutes


def _moment(value: Any) -> datetime | None:
    if value is None:
        return None
    moment = as_moment(value)
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def _name(source: Any) -> str:
    """Of the source, in words: the same source, the same name."""
    if isinstance(source, str | os.PathLike):
        from lostmotion.addresses import is_url, without_password  # noqa: PLC0415

        text = os.fspath(source)
        return without_password(text) if is_url(text) else str(Path(text).absolute())
    if isinstance(source, list | tuple) and source and isinstance(source[0], str | os.PathLike):
        return ", ".join(_name(one) for one in source[:3]) + (f" and {len(source) - 3} more" if len(source) > 3 else "")
    return type(source).__name__
