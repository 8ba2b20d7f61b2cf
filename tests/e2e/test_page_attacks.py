"""What somebody else on the machine, or another web page, can do to the page that the real command serves: nothing."""

from __future__ import annotations

import http.client
import socket
import time

import pytest

from tests.support.plant_rows import HOSTILE
from tests.support.plant_stores import TAGS, plant_store
from tests.support.served import Served

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    folder = tmp_path_factory.mktemp("attacked")
    store = plant_store(folder, (*HOSTILE[:1], *TAGS[1:]))
    made = Served("--store", store, "--keep", folder / "desk")
    yield made
    assert made.stop() == 0


def asked(served, path="/", method="GET", body=None, own=True, **headers):
    """Status, headers and body of an answer; `own`: with the token."""
    host = served.base.removeprefix("http://")
    sent = {"Host": host} | ({"Authorization": f"Bearer {served.token}"} if own else {})
    connection = http.client.HTTPConnection(host, timeout=60)
    try:
        connection.request(method, path, body, sent | {name.replace("_", "-"): one for name, one in headers.items()})
        answer = connection.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()
    finally:
        connection.close()


PLACES = ("/", "/files", "/monitors", "/trend", "/loops/FIC-2", "/api/v1/loops", "/api/v1/trend", "/static/page.css")


@pytest.mark.parametrize("path", PLACES)
def test_without_the_token_nothing_is_shown(served, path):
    status, _, body = asked(served, path, own=False)
    assert status == 403
    assert b"FIC" not in body
    assert asked(served, f"{path}?token=guess", own=False)[0] == 403


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1:1", "localhost.evil.example"])
def test_under_another_name_it_is_not_known(served, host):
    assert asked(served, "/", Host=host)[0] == 421


@pytest.mark.parametrize("origin", ["http://evil.example", "null"])
@pytest.mark.parametrize("path", ["/files", "/loops/FIC-2"])
def test_another_page_writes_nothing(served, origin, path):
    assert asked(served, path, "POST", b"state=accepted&who=x", Origin=origin)[0] == 403


@pytest.mark.parametrize(
    "path",
    [
        "/static/../guard.py", "/static/%2e%2e/guard.py", "/static/..%2fguard.py", "/static//etc/passwd",
        "/files/..%2f..%2fetc%2fpasswd", "/files/../../etc/passwd", "/loops/..%2f..%2fetc%2fpasswd",
        "/trend?source=file:../../../../etc/passwd", "/api/v1/trend?source=file:%2fetc%2fpasswd",
        "/static/%00", "/static/page.css%00.py",
    ],
)  # fmt: skip
def test_no_path_leads_to_other_files(served, path):
    status, _, body = asked(served, path)
    assert status in (400, 404)
    assert b"root:" not in body
    assert b"hmac" not in body


def test_script_in_a_tag_is_text(served):
    for path in ("/", "/api/v1/loops"):
        status, headers, body = asked(served, path)
        assert status == 200
        assert "script-src 'self'" in headers["content-security-policy"]
        if path == "/":
            assert b"<script>alert" not in body
            assert b"&lt;script&gt;alert" in body
        else:
            assert headers["content-type"] == "application/json"


def test_a_gigabyte_is_refused_before_it_comes(served):
    host, _, port = served.base.removeprefix("http://").partition(":")
    head = (
        f"POST /files HTTP/1.1\r\nHost: {host}:{port}\r\nAuthorization: Bearer {served.token}\r\n"
        f"Content-Type: multipart/form-data; boundary=x\r\nContent-Length: {10**9}\r\n\r\n--x\r\n"
    )
    with socket.create_connection((host, int(port)), timeout=30) as line:
        line.sendall(head.encode())
        assert b" 413 " in line.recv(4096).splitlines()[0]


def test_who_sends_a_letter_a_second_keeps_nobody_waiting(served):
    host, _, port = served.base.removeprefix("http://").partition(":")
    lines = [socket.create_connection((host, int(port)), timeout=60) for _ in range(260)]
    for line in lines:
        line.sendall(b"GET / HTTP/1.1\r\nHo")
    began = time.monotonic()
    assert asked(served, "/static/page.css")[0] == 200
    waited = time.monotonic() - began
    assert waited < 10.0, "260 slow clients, and another one is answered"
    for line in lines:
        line.close()


def test_a_head_without_end_is_refused(served):
    host, _, port = served.base.removeprefix("http://").partition(":")
    with socket.create_connection((host, int(port)), timeout=60) as line:
        line.sendall(b"GET / HTTP/1.1\r\nX: " + b"a" * 300_000)
        try:
            said = line.recv(4096)
        except ConnectionResetError:
            said = b""
        assert not said or b" 400 " in said or b" 431 " in said
    assert asked(served, "/static/page.css")[0] == 200
