"""Standard output that is closed or full: no traceback, and the code of what was found."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FULL = Path("/dev/full")
pytestmark = pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full")


def run(words, stdout):
    command = [sys.executable, "-m", "lostmotion", *words]
    return subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, text=True, check=False)


def closed():
    """Writing end of a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.close(reading)
    return writing


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    path = tmp_path_factory.mktemp("record") / "a.csv"
    path.write_text("t_s,OP,PV\n" + "".join(f"{k},{k % 7},{(k * k) % 11}\n" for k in range(300)))
    return path


def test_a_closed_pipe_is_no_failure(record):
    writing = closed()
    seen = run(["check", str(record)], subprocess.DEVNULL)
    done = run(["check", str(record)], writing)
    os.close(writing)
    assert done.stderr == ""
    assert done.returncode in (seen.returncode, 1)


@pytest.mark.long
def test_a_batch_that_nobody_reads_does_all_its_work(record, tmp_path):
    words = ["identify", str(record), str(record.with_name("b.csv")), "--orders", "1,0,1", "--noise", "white"]
    record.with_name("b.csv").write_text(record.read_text())
    seen = run([*words, "--nonlinearity", "none"], subprocess.DEVNULL)
    writing = closed()
    done = run([*words, "--nonlinearity", "none", "--out", str(tmp_path)], writing)
    os.close(writing)
    assert (done.stderr, done.returncode) == (seen.stderr, seen.returncode)
    assert {path.name for path in tmp_path.iterdir()} == {"a.json", "b.json"}


def test_a_full_disk_under_standard_output_is_one_line(record):
    for words in (["check", str(record)], ["check", str(record), "--json"], ["check", "none.csv", "--json"]):
        with FULL.open("w") as full:
            done = run(words, full)
        assert done.returncode == 1
        assert done.stderr.splitlines()[-1].startswith("error: expected room on standard output, got 'No space left")
        assert "Traceback" not in done.stderr
        assert len(done.stderr.splitlines()) == 1


def test_what_was_typed_cannot_make_lines_or_colours():
    done = run(["check", "a\nb\x1b[31m.csv", "--json"], subprocess.PIPE)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "\x1b" not in done.stderr + done.stdout
