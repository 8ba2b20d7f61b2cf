"""The server: own socket, token, limits of a request, and a clean end."""

from __future__ import annotations

import re
import secrets
import signal
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any
from urllib.parse import urlsplit

import uvicorn

from lostmotion.errors import ParameterError
from lostmotion.web.app import create_app
from lostmotion.web.monitors.pages import end_streams
from lostmotion.web.page import Page
from lostmotion.web.server.guard import Guard
from lostmotion.web.server.patience import Patience, PatientProtocol

HEAD_BYTES = 32_768  # of a request before its body
KEEP_ALIVE = 5  # s
LAST = 5  # s in which answers may end once the page is stopped
MOST_CONNECTIONS = 200
NAME = re.compile(r"(?!-)[a-z0-9-]+(?:\.[a-z0-9-]+)*")  # of a public address
LOCAL = ("127.0.0.1", "::1", "localhost")
STOPPING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name))


@dataclass(frozen=True)
class Door:
    """Where the page is found, and who is let in.

    Attributes
    ----------
    address : str
        To bind to.
    port : int
        0: one that is free.
    token : str, optional
        None: one is made, for one browser and for programs. Given: for everybody who has it.
    public : str, optional
        Of :func:`public_origin`: a proxy that ends TLS shows the page there, and only there it answers.
    """

    address: str = LOCAL[0]
    port: int = 0
    token: str | None = None
    public: str | None = None


Fresh = Callable[[], str]


def serve(page: Page, door: Door, ready: Callable[[str, Fresh], None]) -> None:
    """Answer until Ctrl-C or SIGTERM.

    Parameters
    ----------
    page : Page
    door : Door
    ready : callable
        Is given the address with the token as soon as the page answers, and a function that makes a fresh one for one
        more browser (with a token of a file: returns the same, which lets everybody in).

    Raises
    ------
    ParameterError
        The port is taken, or the address is none of this machine.
    """
    with _bound(door) as bound:
        hosts = names(door.address, bound.getsockname()[1]) if door.public is None else public_names(door.public)
        token = door.token or secrets.token_urlsafe(32)
        guarded = Guard(create_app(page), token, hosts, page.read_only, once=door.token is None, public=door.public)
        shown = door.public or f"http://{hosts[0]}"

        def fresh() -> str:
            return f"{shown}/?token={token if door.token is not None else guarded.fresh_token()}"

        server = _Server(_config(Patience(guarded)), lambda: ready(f"{shown}/?token={token}", fresh))
        server.run([bound])


def is_local(address: str) -> bool:
    """Whether only programs of this machine reach it."""
    return address in LOCAL or address.startswith("127.")


def names(address: str, port: int) -> list[str]:
    """Names with port under which the page may be called; the first one is printed.

    Examples
    --------
    >>> names("127.0.0.1", 8000)
    ['127.0.0.1:8000', 'localhost:8000']
    """
    everywhere = address in ("0.0.0.0", "::", "")  # noqa: S104  compared, not bound
    known = [socket.gethostname(), socket.getfqdn()] if not is_local(address) else []
    known = known if everywhere else [_bracketed(address), *known]
    known += ["localhost"] if is_local(address) or everywhere else []
    known += ["127.0.0.1"] if everywhere else []
    ported = [f"{name}:{port}" for name in dict.fromkeys(known)]
    return ported + [name.rpartition(":")[0] for name in ported if port == 80]  # browsers leave the usual one out


def public_origin(given: str) -> str:
    """Origin of an address at which a proxy shows the page, as a browser says it.

    Raises
    ------
    ParameterError
        It is none of https, holds more than a name and a port, or a name that no browser sends.

    Examples
    --------
    >>> public_origin("https://Valves.example/"), public_origin("https://valves.example:8443")
    ('https://valves.example', 'https://valves.example:8443')
    """
    try:
        parts = urlsplit(given)
        name, port = parts.hostname or "", parts.port
    except ValueError:
        parts, name, port = urlsplit(""), "", None
    bare = not (parts.username or parts.password or parts.query or parts.fragment) and parts.path in ("", "/")
    plain = parts.netloc.rpartition(":")[0] if port is not None else parts.netloc
    if parts.scheme != "https" or not NAME.fullmatch(name) or plain.lower() != name or not bare:
        raise ParameterError.expected(
            "https://NAME or https://NAME:PORT as the public address", repr(given[:200]),
            "give the page a name of its own, without a path; letters beyond a to z as xn--..",
        )  # fmt: skip
    return f"https://{name}" + (f":{port}" if port not in (None, 443) else "")


def public_names(origin: str) -> list[str]:
    """What a browser says as the host of a public address; a usual port may be said or not.

    Examples
    --------
    >>> public_names("https://valves.example"), public_names("https://valves.example:8443")
    (['valves.example', 'valves.example:443'], ['valves.example:8443'])
    """
    host = origin.removeprefix("https://")
    return [host] if ":" in host else [host, f"{host}:443"]


def _bracketed(address: str) -> str:
    return f"[{address}]" if ":" in address else address


@contextmanager
def _bound(door: Door) -> Iterator[socket.socket]:
    family = socket.AF_INET6 if ":" in door.address else socket.AF_INET
    # by its full name, else asyncio lets small pieces wait 40 ms for others (TCP_NODELAY)
    with socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP) as made:
        if hasattr(signal, "SIGKILL"):  # on Windows the option would let two servers share a port
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind((door.address, door.port))
        except (OSError, OverflowError) as error:
            what = f"{_bracketed(door.address)}:{door.port}"
            said = getattr(error, "strerror", None) or str(error)
            raise ParameterError.expected(
                f"an address that can be served, as {what}", said.lower(), "give another --port, or 0 for a free one"
            ) from None
        yield made


def _config(app: Any) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        http=PatientProtocol,
        ws="none",
        lifespan="off",
        log_config=None,
        access_log=False,
        proxy_headers=False,
        server_header=False,
        h11_max_incomplete_event_size=HEAD_BYTES,
        limit_concurrency=MOST_CONNECTIONS,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=LAST,
    )


class _Server(uvicorn.Server):
    """Says when it answers, and ends by a signal as by its own will: the command then ends with 0."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Streams that would go on are ended first: nobody waits for them."""
        end_streams()
        await super().shutdown(sockets)

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Without raising them again at the end, as uvicorn does."""
        before = {number: signal.signal(number, self._stop) for number in STOPPING}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _stop(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002  the signature of a handler
        self.force_exit = self.should_exit
        self.should_exit = True
