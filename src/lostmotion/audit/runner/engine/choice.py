"""Engine by its name: processes, inline, dask, or the address of a Dask scheduler."""

from __future__ import annotations

import ipaddress
from typing import Any
from urllib.parse import urlsplit

from lostmotion.audit.runner.engine.inline import Inline
from lostmotion.audit.runner.engine.protocol import Engine
from lostmotion.errors import ParameterError
from lostmotion.extras import extra
from lostmotion.workers import usable_processors

NAMES = "processes, inline, dask, tcp://HOST:PORT or tls://HOST:PORT"
MOST_WORKERS = 1024  # processes: more than any one machine has processors for


def open_engine(
    name: str = "processes", workers: int | None = None, *, insecure: bool = False, security: Any = None
) -> Engine:
    """Engine, to be closed by the caller.

    Parameters
    ----------
    name : str
        "processes" of this machine; "inline": in this process; "dask": a local cluster; or the address of a scheduler.
    workers : int, optional
        None: one a processor. A cluster by its address has those that it has.
    insecure : bool
        Allow ``tcp://`` to another machine: whoever reaches such a scheduler runs what he likes on all of its workers.
    security : distributed.Security, optional
        For ``tls://``; None: as the configuration of Dask says.

    Raises
    ------
    ParameterError
        Another name, no workers, or a scheduler without encryption on another machine.
    DataError
        Dask is not installed.
    EngineError
        No such scheduler.
    """
    if workers is not None and workers < 1:
        raise ParameterError.expected("at least 1 worker", workers, "give the number of processes")
    if workers is not None and workers > MOST_WORKERS:
        raise ParameterError.expected(f"at most {MOST_WORKERS} workers", workers, "give the number of processes")
    if name == "inline":
        return Inline()
    if name == "processes":
        from lostmotion.audit.runner.engine.processes import Processes  # noqa: PLC0415

        return Processes(workers or usable_processors())
    if name != "dask":
        _allowed(name, insecure=insecure)
    with extra("cluster"):
        from lostmotion.audit.runner.engine.dask_engine import cluster_at, local_cluster  # noqa: PLC0415
    return local_cluster(workers or usable_processors()) if name == "dask" else cluster_at(name, security)


def _allowed(address: str, *, insecure: bool) -> None:
    try:
        parts = urlsplit(address)
        host = parts.hostname or ""
        there = parts.scheme in ("tcp", "tls") and bool(host) and parts.port is not None
    except ValueError:
        there = False
    if not there:
        raise ParameterError.expected(f"an engine ({NAMES})", repr(address), "give one of these")
    if parts.scheme == "tcp" and not insecure and not _here(host):
        raise ParameterError.expected(
            f"tls:// for a scheduler on another machine ({host})", "tcp://, which anybody can read and write",
            "set up TLS in Dask, or allow it with insecure=True in a network of your own",
        )  # fmt: skip


def _here(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
