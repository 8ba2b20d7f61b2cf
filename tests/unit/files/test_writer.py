"""Whole or not at all: every file that is written, whatever stops it."""

import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
import textwrap
import time

import pytest

from lostmotion.errors import FileAccessError
from lostmotion.files import writer
from tests.support.killed import begun, ended, forked

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals, links and limits of POSIX")


def left(folder):
    return sorted(path.name for path in folder.rglob("*"))


@pytest.fixture(params=["nameless", "named"])
def way(request, monkeypatch):
    """Both ways to the disk: without a name until all is there, and where the system cannot."""
    if request.param == "named":
        monkeypatch.setattr(writer, "_NAMELESS", 0)


def test_new_and_replaced(way, tmp_path):
    path = writer.write_bytes(tmp_path / "a", b"one")
    with pytest.raises(FileAccessError, match="exists; use force=True"):
        writer.write_bytes(path, b"two")
    path.chmod(0o640)
    writer.write_bytes(path, b"three", force=True)
    assert path.read_bytes() == b"three"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert left(tmp_path) == ["a"]


def test_never_through_a_link_or_onto_a_device(way, tmp_path):
    (tmp_path / "kept").write_text("kept")
    (tmp_path / "link").symlink_to(tmp_path / "kept")
    (tmp_path / "dangling").symlink_to(tmp_path / "none")
    os.mkfifo(tmp_path / "pipe")
    for name, said in (("link", "the link"), ("dangling", "the link"), ("pipe", "device or a pipe")):
        for force in (False, True):
            with pytest.raises(FileAccessError, match=said):
                writer.write_bytes(tmp_path / name, b"x", force)
    with pytest.raises(FileAccessError, match="device"):
        writer.write_bytes("/dev/null", b"x", force=True)
    (tmp_path / ".state.lock").symlink_to(tmp_path / "kept")
    with pytest.raises(FileAccessError, match="the link"):
        writer.lock_file(tmp_path / "state")
    assert (tmp_path / "kept").read_text() == "kept"
    assert not (tmp_path / "none").exists()


def test_what_cannot_be_written_is_known_before(tmp_path):
    (tmp_path / "file").write_text("x")
    for path, said in (
        (tmp_path, "the folder"), (tmp_path / "file" / "none" / "a", "got the file"),
        (tmp_path / "file" / "a", "folder"), (tmp_path / ("n" * 300), "name too long"), (tmp_path / "a\0b", "null"),
        ("/proc/a", "folder that can be written"),
    ):  # fmt: skip
        with pytest.raises(FileAccessError, match=f"(?i){said}"):
            writer.write_bytes(path, b"x", force=True)
    assert writer.write_bytes(tmp_path / ("n" * 255), b"x").exists()
    assert len(left(tmp_path)) == 2


def test_together_or_not_at_all(way, tmp_path):
    (tmp_path / "b").write_text("old")
    with pytest.raises(FileAccessError):
        writer.write_together({tmp_path / name: b"new" for name in "abc"})
    assert left(tmp_path) == ["b"]
    writer.write_together({tmp_path / name: b"new" for name in "abc"}, force=True)
    assert {path.read_bytes() for path in tmp_path.iterdir()} == {b"new"}


def test_a_name_taken_at_the_last_moment_takes_the_others_back(way, tmp_path, monkeypatch):
    place = writer._place

    def just_before(drafts, force):
        (tmp_path / "b").write_text("of somebody else")
        place(drafts, force)

    monkeypatch.setattr(writer, "_place", just_before)
    with pytest.raises(FileAccessError, match="exists"):
        writer.write_together({tmp_path / name: b"new" for name in "abc"})
    assert left(tmp_path) == ["b"]
    assert (tmp_path / "b").read_text() == "of somebody else"


def test_a_new_folder_has_all_or_is_not_there(way, tmp_path, monkeypatch):
    files = dict.fromkeys(("a", "b", "c"), b"x" * 1000)
    writer.write_folder(tmp_path / "p" / "new", files)
    assert left(tmp_path) == ["a", "b", "c", "new", "p"]
    fill, calls = writer._Draft.fill, []

    def full_at_last(draft, data):
        calls.append(draft)
        if len(calls) == 3:
            with writer.write_errors(draft.target, len(data)):
                raise OSError(28, "No space left on device")
        fill(draft, data)

    monkeypatch.setattr(writer._Draft, "fill", full_at_last)
    with pytest.raises(FileAccessError, match=r"room for 1000 bytes .* got 'No space left on device'"):
        writer.write_folder(tmp_path / "other", files)
    assert left(tmp_path) == ["a", "b", "c", "new", "p"]


def test_a_full_disk_is_named_and_leaves_what_was_there(way, tmp_path):
    path = writer.write_bytes(tmp_path / "a", b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, before[1]))
    try:
        for target, force in ((path, True), (tmp_path / "new", False)):
            with pytest.raises(FileAccessError, match=r"room for 100000 bytes .* got 'File too large'; free some"):
                writer.write_bytes(target, bytes(100_000), force)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b"old"
    assert left(tmp_path) == ["a"]


def test_a_kill_at_every_call_leaves_the_old_or_the_new_and_the_next_write_tidies(tmp_path):
    def write():
        writer.write_bytes(folder / "old", b"new" * 1000, force=True)
        writer.write_folder(folder / "folder", dict.fromkeys("ab", b"new" * 1000))

    call, ended = 0, -1
    while ended:
        call += 1
        folder = tmp_path / str(call)
        folder.mkdir()
        (folder / "old").write_bytes(b"old" * 1000)
        ended = forked(write, call)
        assert ended in (0, -signal.SIGKILL)
        assert (folder / "old").read_bytes() in (b"old" * 1000, b"new" * 1000)
        assert not (folder / "folder").exists() or left(folder / "folder") == ["a", "b"]
        assert sum(path.name.startswith(".") for path in folder.iterdir()) <= 1
        shutil.rmtree(folder / "folder", ignore_errors=True)
        write()
        assert left(folder) == ["a", "b", "folder", "old"]
    assert call > 30


def test_two_that_replace_the_same_files_do_not_mix(tmp_path):
    names = [f"{k}" for k in range(8)]

    def write(word):
        for _ in range(10):
            writer.write_folder(tmp_path, dict.fromkeys(names, word), force=True)

    for _ in range(3):
        both = [begun(lambda word=word: write(word)) for word in (b"one", b"two")]
        assert [ended(one) for one in both] == [0, 0]
        assert len({(tmp_path / name).read_bytes() for name in names}) == 1
    assert left(tmp_path) == names


def test_of_two_that_write_a_new_folder_one_is_refused(tmp_path, capfd):
    def write(word):
        writer.write_folder(tmp_path / "new", dict.fromkeys("abc", word))

    both = [begun(lambda word=word: write(word)) for word in (b"one", b"two")]
    assert sorted(ended(one) for one in both) == [0, 1]
    assert "FileAccessError: expected a new file" in capfd.readouterr().err
    assert len({(tmp_path / "new" / name).read_bytes() for name in "abc"}) == 1


def test_sweep_removes_what_a_kill_has_left_of_this_file_only(tmp_path):
    mine, other = (tmp_path / writer._second_name(tmp_path / name) for name in ("state", "other"))
    for path in (mine, other):
        path.write_bytes(b"x")
    writer.sweep(tmp_path / "state")
    assert left(tmp_path) == [other.name]


WRITES_FOR_EVER = """
    import itertools, sys
    from pathlib import Path
    from lostmotion.files import writer
    folder = Path(sys.argv[1])
    print("ready", flush=True)
    for number in itertools.count():
        data = str(number).encode() * 20_000
        writer.write_bytes(folder / "state", data, force=True)
        writer.write_bytes(folder / f"new{number}", data)
        writer.write_folder(folder / f"folder{number}", {name: data for name in ("a", "b", "c")})
"""


def test_after_a_kill_every_file_is_whole(tmp_path):
    """And nothing else is there but, at worst, one second name: of a folder, killed while its files were named."""
    command = [sys.executable, "-c", textwrap.dedent(WRITES_FOR_EVER), str(tmp_path)]
    for delay in (0.003, 0.011, 0.031, 0.067):
        with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
            process.stdout.readline()
            time.sleep(delay)
            process.send_signal(signal.SIGKILL)
        writer.sweep(tmp_path / "state")
        assert sum(path.name.startswith(".") for path in tmp_path.iterdir()) <= 1
        for path in tmp_path.glob("[!.]*"):
            assert not path.is_dir() or left(path) == ["a", "b", "c"]
            for file in path.iterdir() if path.is_dir() else [path]:
                size = file.stat().st_size
                assert size > 0
                assert size % 20_000 == 0
        for path in tmp_path.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(FileAccessError, match="expected a folder, got the file"):
        writer.refuse_folder(tmp_path / "taken", ["a.st"])


def test_a_folder_that_may_not_be_written_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(writer.os, "access", lambda folder, mode: False)  # root may write anywhere
    with pytest.raises(FileAccessError, match="that can be written"):
        writer.refuse(tmp_path / "a.csv")


def test_a_lock_is_for_one(tmp_path):
    with writer.lock_file(tmp_path / "state"), pytest.raises(FileAccessError, match="for this process alone"):
        writer.lock_file(tmp_path / "state")
    with writer.lock_file(tmp_path / "state"):
        pass


def test_a_name_taken_between_two_calls_is_kept(tmp_path, monkeypatch):
    """Without nameless files too: between the look for a file of that name and the call that gives it."""
    monkeypatch.setattr(writer, "_NAMELESS", 0)
    monkeypatch.setattr(writer.os.path, "lexists", lambda path: False)
    (tmp_path / "a").write_bytes(b"of somebody else")
    draft = writer._Draft(tmp_path / "a", tmp_path)
    draft.fill(b"new")
    with pytest.raises(FileAccessError, match="exists"):
        draft.name_it(force=False)
    draft.close()
    assert (tmp_path / "a").read_bytes() == b"of somebody else"
    assert left(tmp_path) == ["a"]
