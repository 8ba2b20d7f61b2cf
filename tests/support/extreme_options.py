"""Every option and argument of every command with extreme values, each run in this process under a limit of time."""

import contextvars
import io
import json
import os
import shutil
import signal
import tempfile
import warnings
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion.cli import main
from lostmotion.cli.commands import COMMANDS, command
from lostmotion.compensate import block_from_model

LIMIT = 60.0  # s of one run
BLOCKING = ("live", "demo-live", "serve", "warm-up")  # run until they are stopped, or compile: options alone are read
NUMBERS = (
    "0", "-0.0", "1", "-1", "5e-324", "-5e-324", "1e-320", "1.7e308", "-1.7e308", "nan", "inf", "-inf", "1e300",
    str(2**63), "-" + str(2**63), "9" * 20, "9" * 5000, "1e3", "0.5",
)  # fmt: skip
WORDS = (
    "", " ", "x", "a\nb", "\x1b[2J", "\u202eabc", "\x07", "../..", "/dev/zero", "/dev/full", "/dev/null/x", "CON",
    "FIC:101", "x" * 300, "é" * 300, "\udcff", "=1+1", "%s%n{}", "--help", "-", "1,2", "1,2,3,4,5,6,7,8,9",
)  # fmt: skip
DATES = ("0001-01-01", "9999-12-31", "2026-01-31T00:00:00+24:00", "2026-02-30", "10000-01-01", "1e9", "0000-00-00")
VALUES = (*NUMBERS, *WORDS, *DATES)
ROUGH = "--left -1 --right 1 --gain 1.5 --time-constant 30 --dt 1 --noise-deviation 0.1".split()  # noqa: SIM905
MODEL = ("--width 2 --gain 1.5 --time-constant 30 --dead-time 4 --dt 1 --noise-deviation 0.1 --kp 1 --ki 0.03").split()  # noqa: SIM905
SOUND = {  # what a command needs besides the option that is tried
    "check": ["a.csv", "--dt", "1"],
    "diagnose": ["a.csv", "--dt", "1"],
    "identify": ["a.csv", "--dt", "1", "--nonlinearity", "backlash", "--orders", "1,0,1"],
    "compensate": ["a.csv", "--dt", "1", "--left", "-1", "--right", "1", "--out", "o.csv"],
    "simulate": [*MODEL, "--samples", "200", "--runs", "1"],
    "design": [*ROUGH, "--op-limits", "-5", "5", "--duration", "150", "--hold", "10"],
    "export": ["b.json", "--to", "st", "--name", "FY_1", "--date", "2026-01-31", "--out", "o", "--replay", "50"],
    "online": ["a.csv", "--dt", "1", "--orders", "1,0,1", "--no-follow"],
    "live": ["opc.tcp://127.0.0.1:1"],
    "request": ["plant.toml", "FIC101", "b.json"],
    "solve": ["a.csv", "--dt", "1"],
    "audit": ["a.csv", "--dt", "1", "--workers", "1"],
    "demo": ["shown"],
    "demo-plant": ["plant", "--loops", "8", "--days", "0.02"],
    "demo-live": ["--seconds", "0.1", "--port", "0"],
    "serve": ["a.csv"],
    "warm-up": [],
    "paper": ["--seeds", "1", "--samples", "1000", "--control-seeds", "2", "--method", "els", "--force"],
}


class LateError(BaseException):
    """A run that took longer than it may; no `except Exception` takes it."""


def cases():
    """(command, words) of every parameter with every value."""
    for name in COMMANDS:
        if name in BLOCKING:
            continue
        for parameter in command(name).params:
            for value in VALUES if not getattr(parameter, "is_flag", False) else ("1",):
                yield name, with_value(name, parameter, value)


def with_value(name, parameter, value):
    """Words of a command: the sound ones, with one parameter replaced."""
    words, option = list(SOUND[name]), parameter.opts[-1]
    if parameter.param_type_name == "argument":
        return [value, *words[1:]] if words else [value]
    if getattr(parameter, "is_flag", False):
        return [*words, option]
    if option in words:
        at = words.index(option)
        del words[at : at + 1 + parameter.nargs]
    first = f"{option}={value}" if parameter.nargs == 1 else option
    return [*words, first, *([value] * parameter.nargs if parameter.nargs > 1 else [])]


@contextmanager
def small_folder():
    """Working folder with a small record and a block."""
    before, rng = Path.cwd(), np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as top:
        place = Path(top, "one", "two", "three")  # ../.. is small
        place.mkdir(parents=True)
        rows = zip(np.repeat(rng.normal(size=40), 5), rng.normal(size=200), strict=True)
        text = "OP,PV\n" + "".join(f"{op:.3f},{op + pv:.3f}\n" for op, pv in rows)
        Path(place, "a.csv").write_text(text, encoding="utf-8")
        made = json.dumps(block_from_model(lm.Backlash(2.0), 1.0).to_dict())
        Path(place, "b.json").write_text(made, encoding="utf-8")
        os.chdir(place)
        try:
            yield place
        finally:
            os.chdir(before)


def tidy(folder):
    """Remove what a run has written beside the record and the block."""
    for path in folder.iterdir():
        if path.name in ("a.csv", "b.json"):
            continue
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


def outcome(name, words):
    """What came of a run, in capitals where it breaks the promise."""
    with _descriptor_2() as raw, _limit():
        try:
            _, err, code = contextvars.copy_context().run(_run, [name, *words])
        except LateError:
            return "HANG"
        except Exception as error:  # noqa: BLE001  it is what is sought
            return f"TRACEBACK {type(error).__name__} {error}"[:160]
    raw_text = raw()
    errors = [line for line in err.splitlines() if line.lower().startswith("error")]
    if code not in (0, 1, 2):
        return f"EXIT {code}"
    if "Traceback" in err or "Warning" in err + raw_text or raw_text.strip():
        return f"STDERR {(raw_text or err)[:120]!r}"
    if any(not line.isprintable() or len(line) > 3500 for line in err.splitlines()):
        return f"UNPRINTABLE {err[:80]!r}"
    if len(errors) > 1 or (code == 2 and not errors):
        return f"LINES {err[:120]!r}"
    return ("done", "done, or refused for the record", "refused in one line")[code]


def _run(words):
    out, err = io.StringIO(), io.StringIO()
    with warnings.catch_warnings(), redirect_stdout(out), redirect_stderr(err):
        warnings.simplefilter("error")
        try:
            main(words)
        except SystemExit as stop:
            code = stop.code if isinstance(stop.code, int) else int(bool(stop.code))
        else:
            code = 0
    return out.getvalue(), err.getvalue(), code


@contextmanager
def _descriptor_2():
    """What libraries write past Python: the descriptor itself leads to a file."""
    kept, text = os.dup(2), []
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield lambda: "".join(text)
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            text.append(file.read().decode(errors="replace"))


@contextmanager
def _limit():
    def late(*_):
        raise LateError

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, LIMIT)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
