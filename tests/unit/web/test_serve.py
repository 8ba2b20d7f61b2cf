"""``lostmotion serve``: what it refuses before a page is opened, names, tokens, and the real command once."""

import os
import signal
import socket
import subprocess
import sys

import httpx
import pytest

from lostmotion.cli import main
from lostmotion.web.server import browser
from lostmotion.web.server.serve import is_local, names
from tests.support.plant_stores import plant_store

OTHER = "192.0.2.7"  # of another machine, in documents


def refused(capsys, *words, code=2):
    """What the command says on standard error where it ends with this code."""
    with pytest.raises(SystemExit) as ended:
        main(["serve", "--no-open", *map(str, words)])
    said = capsys.readouterr()
    assert (ended.value.code, said.out) == (code, "")
    return said.err


def test_a_store_that_is_missing_or_none_is_one_line(capsys, tmp_path):
    said = refused(capsys, "--store", tmp_path / "nix.db")
    assert said.count("\n") == 1
    assert "no such file" in said
    (tmp_path / "old.db").write_bytes(b"SQLite format 3\0")
    assert refused(capsys, tmp_path / "old.db", code=1).count("\n") == 1


def test_files_that_are_not_there_and_two_stores(capsys, tmp_path):
    assert "does not exist" in refused(capsys, tmp_path / "nix.csv")
    assert "one store" in refused(capsys, "postgresql://a@b/c", "--store", "plant.db")


def test_a_port_that_is_taken(capsys, tmp_path):
    address = plant_store(tmp_path, data=False)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        said = refused(capsys, "--store", address, "--port", taken.getsockname()[1], "--read-only")
    assert said.count("\n") == 1
    assert "--port" in said


def test_other_machines_need_a_token_that_others_cannot_read(capsys, tmp_path):
    assert "--token-file" in refused(capsys, "--bind", OTHER)
    token = tmp_path / "token"
    token.write_text("short")
    token.chmod(0o600)
    said = refused(capsys, "--bind", OTHER, "--token-file", token)
    assert "Nothing is encrypted" in said
    assert "5 signs" in said
    token.write_text("a" * 30)
    token.chmod(0o644)
    assert "chmod 600" in refused(capsys, "--bind", OTHER, "--token-file", token, code=1)
    assert "token" in refused(capsys, "--token-file", tmp_path / "nix")


def test_names_under_which_the_page_may_be_called():
    assert names("127.0.0.1", 80) == ["127.0.0.1:80", "localhost:80", "127.0.0.1", "localhost"]
    assert names("::1", 8000)[0] == "[::1]:8000"
    assert "127.0.0.1:8000" in names("::", 8000)
    assert [is_local(one) for one in ("127.0.0.2", "::1", "::", OTHER)] == [True, True, False, False]


def test_a_browser_is_given_a_file_that_only_this_user_can_read(monkeypatch, tmp_path):
    opened = []
    monkeypatch.setattr(browser.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(browser.webbrowser, "open", opened.append)
    monkeypatch.setenv("DISPLAY", ":0")
    browser.open_in_browser("http://127.0.0.1:1/?token=x&a=b")
    (file,) = tmp_path.iterdir()
    assert 'url=http://127.0.0.1:1/?token=x&amp;a=b"' in file.read_text()
    assert file.stat().st_mode & 0o077 == 0 or os.name != "posix"
    assert "token" not in str(opened)
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    browser.open_in_browser("http://127.0.0.1:1/")
    assert len(list(tmp_path.iterdir())) == 1 or sys.platform != "linux"


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="a terminal of its own")
def test_enter_prints_the_address_of_one_more_browser():
    ours, theirs = os.openpty()
    words = [sys.executable, "-m", "lostmotion", "serve", "--no-open", "--port", "0"]
    running = subprocess.Popen(words, stdin=theirs, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        first = running.stdout.readline().strip()
        assert "Press Enter" in running.stderr.readline()
        assert httpx.get(first, timeout=30, follow_redirects=False).status_code == 303
        os.write(ours, b"\n")
        second = running.stdout.readline().strip()
        assert second.partition("?token=")[0] == first.partition("?token=")[0]
        assert httpx.get(first, timeout=30).status_code == 403
        with httpx.Client(follow_redirects=True, timeout=30) as browser:
            assert "Open in another browser" in browser.get(second).text
        running.send_signal(signal.SIGINT)
        assert running.wait(30) == 0, "the thread that listens keeps nothing from ending"
    finally:
        running.kill()
        _, said = running.communicate()
        os.close(ours)
        os.close(theirs)
    assert said == ""


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_the_real_command_answers_and_ends_cleanly(tmp_path):
    words = [sys.executable, "-m", "lostmotion", "serve", "--store", plant_store(tmp_path, data=False), "--no-open",
             "--read-only"]  # fmt: skip
    running = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        address = running.stdout.readline().strip()
        base, _, token = address.partition("/?token=")
        assert base.startswith("http://127.0.0.1:")
        bearer = {"authorization": f"Bearer {token}"}
        assert httpx.get(f"{base}/api/v1/counts", headers=bearer, timeout=30).json()["verdict"]["stiction"] == 1
        assert httpx.get(f"{base}/", timeout=30).status_code == 403
        running.send_signal(signal.SIGINT)
        assert running.wait(30) == 0
    finally:
        running.kill()
        _, said = running.communicate()
    assert said == ""
