"""Who may talk to the page: token, cookie, Host, Origin, and what a browser may do with an answer.

A page on 127.0.0.1 is open to every program of the machine, and by a name that resolves to 127.0.0.1 to every web page
that a browser of the machine shows (DNS rebinding). So nothing is answered without the cookie that the token of the
printed address has become, under another name than the page's own, or to a request that another page has made.
Each address lets one browser in. Who is in already, and the person at the terminal, can have a fresh one.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from html import escape
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

READS = ("GET", "HEAD", "OPTIONS")
ANOTHER = "/address"  # a POST to it makes a fresh address; it changes nothing that is shown
FRESH_TOKEN = "lostmotion.fresh_token"  # noqa: S105  key of a scope, under which routes find `Guard.fresh_token`
HEADERS = {
    "content-security-policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "same-origin",  # with "no-referrer" a browser says of its own forms that they come from nowhere
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), microphone=(), geolocation=()",
}


UNKNOWN = "Refused: open the address that was printed when the page was started."
USED = "This address was used already, or replaced by a newer one."
WAYS = 'For a new address: press Enter in the terminal of the page, or "Open in another browser" in the open page.'


class Guard:
    """ASGI middleware that lets through whom the person who started the page has let in.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    token : str
        Of the printed address. It becomes a cookie, and is used up once the cookie has come back. As
        ``Authorization: Bearer TOKEN`` it lets programs in, as often as they like.
    hosts : iterable of str
        Names with port under which the page may be called.
    read_only : bool
        Refuse every request that changes something.
    once : bool
        Whether the address is used up by the first browser; False: for everybody who was given the token.
    public : str, optional
        Origin under which a proxy that ends TLS shows the page, as "https://valves.example". Changes are then taken
        from it alone, and the cookie is for it alone. No header of a proxy is believed: anybody can send them.
    """

    def __init__(
        self, app: App, token: str, hosts: Iterable[str], read_only: bool = False, *, once: bool = True,
        public: str | None = None,
    ) -> None:  # fmt: skip
        self._app = app
        self._token = token
        self._hosts = {host.lower() for host in hosts}
        self._read_only = read_only
        self._once = once
        self._public = public
        self._open = token  # of the address that lets the next browser in; empty: it is used up
        self._cookie_of_next = secrets.token_urlsafe(32)
        self._sessions: list[str] = []  # cookies that were given out
        self._ended: list[str] = []  # tokens of addresses that are used up or replaced
        name = "lostmotion_" + "".join(sign for sign in min(self._hosts, default="") if sign.isalnum())
        self.cookie = name if public is None else f"__Host-{name}"  # no neighbouring name can set one that is called so

    def fresh_token(self) -> str:
        """Token of a new address for one more browser; one that nobody has used is replaced."""
        self._end_address()
        self._open, self._cookie_of_next = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        return self._open

    def _end_address(self) -> None:
        if self._open:
            self._ended.append(self._open)
        self._open = ""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or have it answered."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return
        headers = _headers(scope)
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _answer(send, *refusal)
            return
        if self._known(headers):
            if self._once:
                scope[FRESH_TOKEN] = self.fresh_token
            await self._app(scope, receive, _with_headers(send))
            return
        await self._let_in(scope, headers, send)

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> tuple[int, str] | None:
        """Why a request is refused whoever makes it; None: it is not."""
        if headers.get("host", "").lower() not in self._hosts:
            return 421, "This page is not known under that name. Use the address that was printed."
        if scope["method"] in READS:
            return None
        if self._read_only and scope["path"] != ANOTHER:
            return 403, "The page is read-only here."
        origin = headers.get("origin")
        own = {self._public} if self._public is not None else {f"{scope['scheme']}://{host}" for host in self._hosts}
        same = origin is not None and origin.lower() in own
        if not same and not (origin is None and self._bears(headers)):
            return 403, "Refused: the request comes from another page."
        return None

    def _known(self, headers: dict[str, str]) -> bool:
        if self._bears(headers):
            return True
        pairs = (one.strip().partition("=") for one in headers.get("cookie", "").split(";"))
        brought = [value for name, _, value in pairs if name == self.cookie and _among(value, self._sessions)]
        if self._once and _among(self._cookie_of_next, brought):
            self._end_address()
        return bool(brought)

    def _bears(self, headers: dict[str, str]) -> bool:
        kind, _, given = headers.get("authorization", "").partition(" ")
        return kind.lower() == "bearer" and _alike(given.strip(), self._token)

    async def _let_in(self, scope: Scope, headers: dict[str, str], send: Send) -> None:
        """Make the cookie of the token, or refuse.

        A browser that is led here (by a link in a mail, by the file that opened it) brings no strict cookie, not even
        through a redirect; from a page of this server it does. So it is given one that leads on. It holds nothing, and
        where there is no cookie the way ends behind it.
        """
        fields = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        given = dict(fields).get("token", "")
        if not given and scope["method"] == "GET" and _from_elsewhere(headers):
            await _lead_on(send, _where(scope, fields))
            return
        if scope["method"] != "GET" or not given or not _alike(given, self._open):
            used = scope["method"] == "GET" and _among(given, self._ended)
            await _answer(send, 403, f"{USED if used else UNKNOWN} {WAYS if self._once else ''}".rstrip())
            return
        if self._cookie_of_next not in self._sessions:
            self._sessions.append(self._cookie_of_next)
        where = _where(scope, fields)
        cookie = f"{self.cookie}={self._cookie_of_next}; HttpOnly; SameSite=Strict; Path=/"
        secure = "; Secure" if self._public is not None or scope["scheme"] == "https" else ""
        if _by_itself(headers):
            await _answer(send, 303, "", {"location": where, "set-cookie": cookie + secure})
        else:
            await _lead_on(send, where, {"set-cookie": cookie + secure})


def _where(scope: Scope, fields: list[tuple[str, str]]) -> str:
    """Address of the request without its token."""
    rest = urlencode([(name, value) for name, value in fields if name != "token"])
    path = "/" + scope["path"].lstrip("/\\")  # "//other.host" would lead elsewhere
    return quote(path) + (f"?{rest}" if rest else "")


def _by_itself(headers: dict[str, str]) -> bool:
    """Whether nothing else has led here: an address that was typed, or no browser at all."""
    return headers.get("sec-fetch-site") in ("none", "same-origin") or "text/html" not in headers.get("accept", "")


def _from_elsewhere(headers: dict[str, str]) -> bool:
    """Whether a browser shows the page because another one leads to it."""
    other = headers.get("sec-fetch-site") in ("cross-site", "same-site")
    return other and headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"


def _headers(scope: Scope) -> dict[str, str]:
    """By lower-case name; of one that comes twice all, so that it fits nothing."""
    found: dict[str, str] = {}
    for name, value in scope["headers"]:
        key = name.decode("latin-1").lower()
        text = value.decode("latin-1")
        found[key] = f"{found[key]}, {text}" if key in found else text
    return found


def _alike(one: str, other: str) -> bool:
    return hmac.compare_digest(one.encode(), other.encode())


def _among(given: str, known: Iterable[str]) -> bool:
    """Whether it is one of them."""
    return any(_alike(given, one) for one in known)


def _with_headers(send: Send) -> Send:
    """Send that adds the headers of safety to an answer, and keeps it out of caches where nothing else is said."""

    async def sent(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            present = {name.lower() for name, _ in message["headers"]}
            wanted = {**HEADERS, "cache-control": "no-store"}
            added = [(k.encode(), v.encode()) for k, v in wanted.items() if k.encode() not in present]
            message = {**message, "headers": [*message["headers"], *added]}
        await send(message)

    return sent


async def _lead_on(send: Send, where: str, headers: dict[str, str] | None = None) -> None:
    """A page that leads to another one of this server."""
    to = escape(where)
    text = (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={to}">'
        f'<link rel="icon" href="data:,"><title>lostmotion</title><p><a href="{to}">Go on</a></p></html>'
    )
    told = {"content-type": "text/html; charset=utf-8", "cache-control": "no-store", **(headers or {})}
    await _answer(send, 200, text, told)


async def _answer(send: Send, status: int, text: str, headers: dict[str, str] | None = None) -> None:
    body = text.encode()
    told = {"content-type": "text/plain; charset=utf-8", "content-length": str(len(body)), **(headers or {})}
    pairs = [(name.encode(), value.encode("latin-1")) for name, value in {**HEADERS, **told}.items()]
    await send({"type": "http.response.start", "status": status, "headers": pairs})
    await send({"type": "http.response.body", "body": body})
