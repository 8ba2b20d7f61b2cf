"""The one place where a connection to a server is made."""

from __future__ import annotations

import ipaddress
from typing import Any
from urllib.parse import urlparse

from asyncua.client.client import Client
from asyncua.ua.uaerrors import UaError

from lostmotion.addresses import without_password
from lostmotion.errors import FileAccessError, ParameterError

REQUEST = 4.0  # s for the answer to one request
WATCH = 2.0  # s between looks whether the server is still there


async def connected(address: str, identity: Any = None, trust: Any = None, insecure: bool = False) -> Client:  # noqa: ARG001
    """Client with an open session; the caller disconnects it. It does not reconnect by itself.

    Parameters
    ----------
    address : str
        ``opc.tcp://host:port/path``, without user or password.
    identity : optional
        Who we are: certificate, user.
    trust : optional
        Which servers are believed.
    insecure : bool
        Neither signed nor encrypted: a bench on this machine only.

    Raises
    ------
    ParameterError
        Not such an address, or nothing said about security.
    FileAccessError
        No such server, or it refuses.
    """
    check_address(address)
    if not insecure or not on_this_machine(address):
        raise ParameterError.expected(
            "an address on this machine, and insecure", without_password(address), "connect securely"
        )
    client = Client(address, timeout=REQUEST, watchdog_intervall=WATCH)
    try:
        await client.connect()
    except (OSError, TimeoutError, UaError) as error:
        raise unreachable(address, error) from error
    return client


def check_address(address: str) -> None:
    """Refuse what is no address of a server, and one with a password in it."""
    parts = urlparse(address)
    if parts.scheme != "opc.tcp" or not parts.hostname:
        raise ParameterError.expected("an address opc.tcp://host:port", repr(without_password(address)), "correct it")
    if parts.username or parts.password:
        raise ParameterError.expected(
            "an address without user and password", without_password(address), "name a file or a variable for them"
        )


def on_this_machine(address: str) -> bool:
    """Whether the host of an address is this machine.

    Examples
    --------
    >>> [on_this_machine(f"opc.tcp://{host}:4840") for host in ("localhost", "127.0.0.1", "[::1]", "plc1")]
    [True, True, True, False]
    """
    host = urlparse(address).hostname or ""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def unreachable(address: str, error: BaseException) -> FileAccessError:
    """Error for a server that cannot be reached or refuses, without what may be secret."""
    why = str(error) or type(error).__name__
    return FileAccessError(f"expected a server at {without_password(address)}, got {why[:200]!r}; check that it runs")
