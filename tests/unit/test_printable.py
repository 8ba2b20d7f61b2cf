"""What comes from outside is shown, and neither steers a terminal nor runs in a shell."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion.cli.sources import words_of
from lostmotion.errors import one_line
from lostmotion.printable import label, printable, shell_line, shell_word
from lostmotion.records import LoopRecord
from tests.support.places import ROOT

STEERING = [
    "\x1b]0;x\x07", "\x1b[31m", "\x9b31m", "\x90q\x9c", "\r", "\b", "\v", "\f", "\0", "\x7f", "\x85",
    "\u200e", "\u202e", "\u2066", "\u2069", "\u061c", "\u2028", "\u2029", "\ufeff", "\u00ad", "\U000e0041", "\udc80",
]  # fmt: skip


@pytest.mark.parametrize("steering", STEERING)
def test_nothing_steers_a_terminal(steering):
    text = f"FIC{steering}101 m³/h ×\nüß"
    shown = printable(text)
    assert shown.replace("\n", "").isprintable()
    assert shown.startswith("FIC\\")
    assert shown.endswith("101 m³/h ×\nüß")
    assert one_line(text).isprintable()
    assert shell_word(text).isprintable()
    assert printable(shown) == shown


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\v", "\f", "\x1c", "\x85", "\u2028", "\u2029"])
def test_a_label_has_one_line(end):
    assert len(label(f"FIC{end}101").splitlines()) == 1
    assert label("\0\x1b\x7f\x9b\udce9m³/h\u200f") == r"\x00\x1b\u007f\x9b\udce9m³/h" + "\u200f"
    assert len(LoopRecord([1, 2], [3, 4], dt=1.0, tag=f"FIC{end}101", pv_unit=f"m3{end}").tag.splitlines()) == 1


WORDS = [
    "a b.csv", "it's", "$(id)", "`id`", "a;b", "a|b", "a&b", "~", "=ls", "*", "?", "[a]", "{a,b}", "!x", "#x",
    '"', "\\", "",
    "a\nb", "\x1b]0;x\x07'\\", "ü\x1b", "\udc80\udcff", "\u202e\x7f", "-x", "\\n\n",
]  # fmt: skip


@pytest.mark.parametrize("shell", [one for one in ("bash", "zsh", "ksh") if shutil.which(one)])
def test_a_shell_takes_each_word_as_it_is(shell):
    back = "import os, sys; sys.stdout.buffer.write(b'\\0'.join(map(os.fsencode, sys.argv[1:])))"
    line = shell_line([sys.executable, "-c", back, *WORDS])
    assert line.isprintable()
    done = subprocess.run([shell, "-c", line], capture_output=True, check=True, env={"LC_ALL": "C.UTF-8"})
    assert [one.decode("utf-8", "surrogateescape") for one in done.stdout.split(b"\0")] == WORDS


def test_a_file_whose_name_begins_like_an_option_is_a_file():
    assert words_of(Path("-rf.csv")) == ["./-rf.csv"]


def test_commands_print_through_one_place():
    found = {
        path.name
        for path in (ROOT / "src" / "lostmotion" / "cli").glob("*.py")
        if re.search(
            r"typer\.(echo|secho)|^ *print\(|std(out|err)\.write", path.read_text(encoding="utf-8"), re.MULTILINE
        )
    }
    assert found == {"closed_output.py", "progress.py"}  # the latter moves the cursor
