"""Who may talk to the page: each attack of the list is a test."""

from __future__ import annotations

import re
from typing import Any

import httpx
import pytest

from lostmotion.errors import ParameterError
from lostmotion.web.app import create_app
from lostmotion.web.page import Page
from lostmotion.web.server.guard import HEADERS, Guard
from lostmotion.web.server.serve import public_origin

BASE = "http://127.0.0.1:8000"
HOSTS = ("127.0.0.1:8000", "localhost:8000")
TOKEN = "t0ken"


async def app(scope: Any, receive: Any, send: Any) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-type", b"text/plain")]})
    await send({"type": "http.response.body", "body": b"secret"})


def client(base: str = BASE, **settings: Any) -> httpx.AsyncClient:
    guard = Guard(app, TOKEN, HOSTS, **settings)
    return httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url=base)


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


pytestmark = pytest.mark.anyio


async def test_token_becomes_a_cookie_and_is_used_up() -> None:
    async with client() as browser:
        first = await browser.get(f"/plant?area=A&token={TOKEN}")
        assert (first.status_code, first.headers["location"]) == (303, "/plant?area=A")
        cookie = first.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        assert (await browser.get("/plant?area=A")).text == "secret"
        browser.cookies.clear()
        again = await browser.get(f"/?token={TOKEN}")
        assert (again.status_code, "used already" in again.text) == (403, True)


async def test_a_look_ahead_does_not_use_the_token_up() -> None:
    async with client() as browser:
        await browser.get(f"/?token={TOKEN}")
        browser.cookies.clear()
        assert (await browser.get(f"/?token={TOKEN}")).status_code == 303


async def let_in(guard: Guard, token: str) -> httpx.AsyncClient:
    """A browser that has opened an address and come back."""
    browser = httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url=BASE)
    assert (await browser.get(f"/?token={token}")).status_code == 303
    assert (await browser.get("/")).text == "secret"
    return browser


async def test_a_fresh_address_lets_one_more_browser_in_and_the_first_one_stays() -> None:
    guard = Guard(app, TOKEN, HOSTS)
    first = await let_in(guard, TOKEN)
    fresh = guard.fresh_token()
    second = await let_in(guard, fresh)
    assert (await first.get("/")).text == "secret"
    assert first.cookies[guard.cookie] != second.cookies[guard.cookie]
    async with client() as third:
        third._transport = httpx.ASGITransport(guard)
        for token in (TOKEN, fresh):
            refusal = await third.get(f"/?token={token}")
            assert (refusal.status_code, "press Enter" in refusal.text) == (403, True)
        assert (await third.get("/", headers={"authorization": f"Bearer {fresh}"})).status_code == 403


async def test_a_newer_address_replaces_one_that_nobody_used() -> None:
    guard = Guard(app, TOKEN, HOSTS)
    old, new = guard.fresh_token(), guard.fresh_token()
    async with httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url=BASE) as browser:
        for token in (TOKEN, old, ""):
            assert (await browser.get(f"/?token={token}")).status_code == 403
        assert (await browser.get("/", headers={"authorization": f"Bearer {TOKEN}"})).text == "secret"
        assert (await browser.get(f"/?token={new}")).status_code == 303


@pytest.mark.parametrize("read_only", [False, True])
async def test_the_page_gives_a_fresh_address_to_its_own_form_only(read_only: bool) -> None:
    guard = Guard(create_app(Page(read_only=read_only, fresh_addresses=True)), TOKEN, HOSTS, read_only)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url=BASE) as browser:
        assert (await browser.post("/address", headers={"origin": BASE})).status_code == 403, "without the cookie"
        await browser.get(f"/?token={TOKEN}")
        for headers in ({}, {"origin": "http://evil.example"}, {"origin": "null"}):
            assert (await browser.post("/address", headers=headers)).status_code == 403
        assert (await browser.get("/address")).status_code == 405
        shown = await browser.post("/address", headers={"origin": BASE})
        (token,) = re.findall(rf'value="{BASE}/\?token=([\w-]+)"', shown.text)
        assert shown.headers["cache-control"] == "no-store"
        browser.cookies.clear()
        assert (await browser.get(f"/?token={token}")).status_code == 303


async def test_with_the_token_of_a_file_there_are_no_fresh_addresses() -> None:
    guard = Guard(create_app(Page()), TOKEN, HOSTS, once=False)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url=BASE) as browser:
        await browser.get(f"/?token={TOKEN}")
        assert (await browser.post("/address", headers={"origin": BASE})).status_code == 404


@pytest.mark.parametrize("path", ["/", "/?token=", "/?token=wrong", "/?token=t0ke", "/?Token=t0ken"])
async def test_without_the_token_nothing_is_answered(path: str) -> None:
    async with client() as browser:
        answer = await browser.get(path)
        assert answer.status_code == 403
        assert "secret" not in answer.text


@pytest.mark.parametrize(
    "host", ["evil.example:8000", "127.0.0.1", "127.0.0.1:8001", "", "127.0.0.1:8000.evil.example"]
)
async def test_another_name_is_refused_even_with_the_token(host: str) -> None:
    async with client() as browser:
        answer = await browser.get(f"/?token={TOKEN}", headers={"host": host})
        assert answer.status_code == 421
        assert "set-cookie" not in answer.headers


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:8000", "http://127.0.0.1:9000"])
async def test_a_write_from_another_page_is_refused_with_the_cookie(origin: str) -> None:
    async with client() as browser:
        await browser.get(f"/?token={TOKEN}")
        assert (await browser.post("/x", headers={"origin": origin})).status_code == 403
        assert (await browser.post("/x")).status_code == 403, "a browser says where a write comes from"
        assert (await browser.post("/x", headers={"origin": BASE})).status_code == 200


async def test_programs_bear_the_token() -> None:
    async with client() as program:
        bearer = {"authorization": f"Bearer {TOKEN}"}
        assert (await program.get("/api/loops", headers=bearer)).text == "secret"
        assert (await program.post("/api/loops", headers=bearer)).status_code == 200
        assert (
            await program.post("/api/loops", headers={**bearer, "origin": "http://evil.example"})
        ).status_code == 403
        assert (await program.get("/", headers={"authorization": "Bearer wrong"})).status_code == 403


async def test_read_only_refuses_every_write() -> None:
    async with client(read_only=True) as browser:
        await browser.get(f"/?token={TOKEN}")
        assert (await browser.get("/")).status_code == 200
        for method in ("POST", "PUT", "PATCH", "DELETE"):
            assert (await browser.request(method, "/", headers={"origin": BASE})).status_code == 403


async def test_every_answer_carries_the_headers() -> None:
    async with client() as browser:
        answers = [
            await browser.get(f"/?token={TOKEN}"),
            await browser.get("/"),
            await browser.get("/", headers={"host": "x"}),
        ]
        for answer in answers:
            assert {name: answer.headers[name] for name in HEADERS} == HEADERS
        assert answers[1].headers["cache-control"] == "no-store"
        assert "unsafe" not in HEADERS["content-security-policy"]


@pytest.mark.parametrize("path", ["//evil.example/", "/\\evil.example", "///evil.example"])
async def test_the_way_in_leads_nowhere_else(path: str) -> None:
    sent: list[Any] = []
    scope = {
        "type": "http", "method": "GET", "path": path, "query_string": f"token={TOKEN}".encode(), "scheme": "http",
        "headers": [(b"host", b"127.0.0.1:8000")],
    }  # fmt: skip

    async def send(message: Any) -> None:
        sent.append(message)

    await Guard(app, TOKEN, HOSTS)(scope, None, send)  # type: ignore[arg-type]
    where = dict(sent[0]["headers"])[b"location"].decode()
    assert where.startswith("/")
    assert where[1] not in "/\\"


async def test_header_split_by_a_path_is_harmless() -> None:
    sent: list[Any] = []
    scope = {
        "type": "http", "method": "GET", "path": "/a\r\nset-cookie: x=1/\u20ac", "scheme": "http",
        "query_string": f"token={TOKEN}".encode(), "headers": [(b"host", b"127.0.0.1:8000")],
    }  # fmt: skip

    async def send(message: Any) -> None:
        sent.append(message)

    await Guard(app, TOKEN, HOSTS)(scope, None, send)  # type: ignore[arg-type]
    location = dict(sent[0]["headers"])[b"location"]
    assert b"\r" not in location
    assert b"\n" not in location


async def test_cookies_that_are_none_are_no_error() -> None:
    async with client() as browser:
        for cookie in ("=", "a", "\x01", "lostmotion_1270018000=", "x=" + "y" * 9000):
            assert (await browser.get("/", headers={"cookie": cookie.encode("latin-1")})).status_code == 403


LED = {"accept": "text/html,*/*", "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate",
       "sec-fetch-dest": "document"}  # fmt: skip


async def test_who_is_led_here_gets_the_cookie_and_a_page_that_leads_on() -> None:
    async with client() as browser:
        answer = await browser.get(f'/plant?area=A"<&token={TOKEN}', headers=LED)
        assert (answer.status_code, "SameSite=Strict" in answer.headers["set-cookie"]) == (200, True)
        assert 'content="0; url=/plant?area=A%22%3C"' in answer.text
        assert "secret" not in answer.text


async def test_a_link_from_elsewhere_leads_on_without_the_cookie_and_ends_there() -> None:
    async with client() as browser:
        answer = await browser.get("/plant?a=1&b=2", headers=LED)
        assert (answer.status_code, "set-cookie" in answer.headers) == (200, False)
        assert 'url=/plant?a=1&amp;b=2"' in answer.text
        again = await browser.get("/plant?a=1&b=2", headers={**LED, "sec-fetch-site": "same-origin"})
        assert again.status_code == 403


@pytest.mark.parametrize("name", ["sec-fetch-mode", "sec-fetch-dest"])
async def test_what_is_no_page_of_a_browser_is_not_led_on(name: str) -> None:
    async with client() as browser:
        assert (await browser.get("/", headers={**LED, name: "no-cors"})).status_code == 403
        assert (await browser.post("/", headers=LED)).status_code == 403


async def test_a_token_of_a_file_lets_in_everybody_who_has_it() -> None:
    async with client(once=False) as browser:
        for _ in range(2):
            assert (await browser.get(f"/?token={TOKEN}")).status_code == 303
            assert (await browser.get("/")).status_code == 200
            browser.cookies.clear()
        assert (await browser.get("/?token=other")).status_code == 403


PUBLIC = "https://valves.example"


def behind() -> httpx.AsyncClient:
    """A browser that comes through a proxy which ends TLS: to the page it speaks plain HTTP."""
    guard = Guard(app, TOKEN, ("valves.example", "valves.example:443"), once=False, public=PUBLIC)
    return httpx.AsyncClient(transport=httpx.ASGITransport(guard), base_url="http://valves.example")


async def test_behind_a_proxy_the_cookie_is_for_tls_and_this_name_only() -> None:
    async with behind() as browser:
        cookie = (await browser.get(f"/?token={TOKEN}")).headers["set-cookie"]
        assert cookie.startswith("__Host-lostmotion_")
        for part in ("Secure", "HttpOnly", "SameSite=Strict", "Path=/"):
            assert part in cookie.split("; ")
        assert "domain" not in cookie.lower()


@pytest.mark.parametrize(
    "origin",
    [
        "http://valves.example", "https://valves.example:8443", "https://valves.example.evil.example", "null",
        "https://evil.example", "https://evil.valves.example", "http://127.0.0.1:8000", "https://valves.example, x",
        "https://valves.example/", "https://valves.example@evil.example", "",
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    "forged",
    [{}, {"x-forwarded-proto": "https", "x-forwarded-host": "evil.example", "forwarded": "host=evil.example"}],
)
async def test_behind_a_proxy_writes_come_from_the_public_page_alone(origin: str, forged: dict[str, str]) -> None:
    async with behind() as browser:
        cookie = (await browser.get(f"/?token={TOKEN}")).headers["set-cookie"].partition(";")[0]
        known = {"cookie": cookie, **forged}  # httpx itself keeps a Secure cookie from plain HTTP, as a browser does
        assert (await browser.get("/", headers=known)).text == "secret"
        assert (await browser.post("/x", headers={**known, "origin": origin})).status_code == 403
        assert (await browser.post("/x", headers=known)).status_code == 403
        assert (await browser.post("/x", headers={**known, "origin": PUBLIC})).status_code == 200
        assert (await browser.post("/x", headers={"origin": PUBLIC})).status_code == 403, "without the cookie"


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8000", "localhost", "evil.example", "valves.example:8443", "valves.example.evil.example", ""]
)
async def test_behind_a_proxy_no_other_name_is_known(host: str) -> None:
    async with behind() as browser:
        forged = {"host": host, "x-forwarded-host": "valves.example", "authorization": f"Bearer {TOKEN}"}
        assert (await browser.get(f"/?token={TOKEN}", headers=forged)).status_code == 421


async def test_headers_of_a_proxy_are_not_believed() -> None:
    async with client() as browser:
        await browser.get(f"/?token={TOKEN}")
        forged = {"origin": "https://127.0.0.1:8000", "x-forwarded-proto": "https"}
        assert (await browser.post("/x", headers=forged)).status_code == 403


@pytest.mark.parametrize(
    "given",
    [
        "http://valves.example", "valves.example", "https://", "https://valves.example/page", "https://a@valves.example",
        "https://valves.example?x", "https://valves.example#x", "https://vàlves.example", "https://valves.example:x",
        "https://valves.example:99999", "https://*.example", "https://valves..example", "https://[::1]", "ftp://a.b",
        "https://valves.example\\@evil.example", "https://val ves.example", "https://-a.example",
    ],
)  # fmt: skip
async def test_a_public_address_is_a_name_and_a_port(given: str) -> None:
    with pytest.raises(ParameterError, match="public address"):
        public_origin(given)
