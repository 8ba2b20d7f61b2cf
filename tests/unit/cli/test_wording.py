"""Errors on the command line: every remedy names options that are there, and following it literally leads on."""

import ast
import json
import shlex
from pathlib import Path

import pytest
import typer

import lostmotion
from lostmotion.cli import app, main
from lostmotion.cli.commands_on import commands_on
from lostmotion.cli.wording import OFFERED, SETTING, advice, as_options, message, named_options
from lostmotion.errors import DataError, FileAccessError, ParameterError, TimeError

SOURCE = Path(lostmotion.__file__).parent
COMMANDS = typer.main.get_command(app).commands
EVERY_OPTION = {option for command in COMMANDS.values() for each in command.params for option in each.opts}
ROLES = ("op", "pv", "sp", "position", "time", "mode")
PYTHON_ONLY = {  # no command can raise it
    "missing",  # no command asks for missing="error"
    "cases",  # studies with failures of one's own
    "b",  # coefficients of a LinearModel
    "band",  # --set band=0.2 is a command's own
}
PYTHON_FILES = {"files/frames.py", "identify/data.py"}  # arrays and frames that a program hands in


def remedies():
    """Text of each remedy in the source, placeholders filled in, with its file."""
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args:
                if node.func.attr in {"expected", "missing"}:
                    yield from ((path.relative_to(SOURCE).as_posix(), text) for text in texts(node.args[-1]))
            elif isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") in {"remedy", "ignore", "hint"}:
                yield from ((path.relative_to(SOURCE).as_posix(), text) for text in texts(node.value))


def texts(node):
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) else []
    if isinstance(node, ast.IfExp):
        return [*texts(node.body), *texts(node.orelse)]
    if isinstance(node, ast.BinOp):
        return [left + right for left in texts(node.left) or [""] for right in texts(node.right) or [""]]
    if not isinstance(node, ast.JoinedStr):
        return []
    whole = [""]
    for part in node.values:
        if isinstance(part, ast.Constant):
            fills = (part.value,)
        elif ast.unparse(part.value) == "role":
            fills = ROLES
        else:
            fills = ("'x'" if part.conversion == ord("r") else "1",)
        whole = [text + fill for text in whole for fill in fills]
    return whole


FOUND = sorted(set(remedies()))
NAMING = [(file, text) for file, text in FOUND if SETTING.search(text)]


@pytest.fixture(autouse=True)
def no_command_runs():
    """Commands that tests ran before leave their options behind."""
    before = OFFERED.set(frozenset())
    yield
    OFFERED.reset(before)


def test_remedies_were_found():
    assert len(FOUND) > 150
    assert len(NAMING) > 25


@pytest.mark.parametrize(("file", "text"), NAMING)
def test_every_setting_in_a_remedy_is_an_option(file, text):
    missing = set(named_options(text)) - EVERY_OPTION - PYTHON_ONLY
    if file in PYTHON_FILES or not missing:
        return
    assert not SETTING.search(advice(text, EVERY_OPTION)), "no other way out is named"


def test_renders_to_options_that_can_be_typed():
    assert as_options("pass dt=<seconds> and time=False to ignore it") == "pass --dt SECONDS --ignore-time to ignore it"
    assert as_options("name it with op='FIC 101.OP'") == "name it with --op 'FIC 101.OP'"
    assert as_options('say which: op="it\'s"') == "say which: --op 'it'\"'\"'s'"
    assert as_options("dt=10, or dt=12.5 with time=False") == "--dt 10, or --dt 12.5 with --ignore-time"
    assert as_options("say which, automatic=(..)") == "say which, --auto-value WORD"
    assert as_options("take method='two moves'") == "take --method 'two moves'"
    assert as_options('e.g. wanted={"width": 0.2}, or duration=seconds') == "e.g. --interval 0.2, or --duration SECONDS"
    assert as_options("--set band=0.2; span=(0.0, 100.0)") == "--set band=0.2; --span 0.0 100.0"
    assert as_options("x == 3, use to_dict(), dt = 3 s") == "x == 3, use to_dict(), dt = 3 s"


def test_what_was_got_is_not_reworded():
    error = DataError.expected("6 fields", "'dt=5;time=False'", "repair the line, or give dt=<seconds>")
    assert message(error, ["--dt"]) == "expected 6 fields, got 'dt=5;time=False'; repair the line, or give --dt SECONDS"
    assert str(error).endswith("give dt=<seconds>")
    assert message(FileAccessError("expected a new file, got raw=True.csv; use force=True to replace it"), []) == (
        "expected a new file, got raw=True.csv; use --force to replace it"
    )


ROWS = range(300)


def csv(rows, header="time,OP,PV"):
    return "\n".join([header, *rows, ""])


def said_by(capsys, *words):
    """Error of a command, or "" where it gave none."""
    with pytest.raises(SystemExit):
        main([*map(str, words)])
    error = capsys.readouterr().err
    assert "=False" not in error
    assert "='" not in error
    return error.removeprefix("error: ").strip()


FOLLOWED = {
    "other names": (csv([f"{k},{k % 7},{k % 5}" for k in ROWS], "time,FV,PV"), "--op COLUMN", "--op FV"),
    "no such column": (csv([f"{k},{k % 7},{k % 5}" for k in ROWS], "time,OP,FT"), "--pv COLUMN", "--pv FT"),
    "two OP": (csv([f"{k},{k % 7},{k % 5},{k % 3}" for k in ROWS], "time,CO,PV,MV"), "--op CO", "--op CO"),
    "two clocks": (
        csv([f"{10 * k},{k % 7},{k % 5},12" for k in ROWS], "time,OP,PV,ts"),
        "give the true one: --dt 10, or --dt 12 --ignore-time",
        "--dt 12 --ignore-time",
    ),
    "the other clock": (csv([f"{10 * k},{k % 7},{k % 5},12" for k in ROWS], "time,OP,PV,ts"), "--dt 10", "--dt 10"),
    "uneven minute stamps": (
        csv([f"{120 * (k // 11) + 60 * (k % 11 > 1)},{k % 7},{k % 5}" for k in ROWS]), "give --dt 1", "--dt 11",
    ),
    "one stamp": (
        csv([f"7,{k % 7},{k % 5}" for k in ROWS]), "pass --dt SECONDS --ignore-time", "--dt 2 --ignore-time",
    ),
    "repeated": (
        csv([f"{k - (k == 9)},{k % 7},{k % 5}" for k in ROWS]), "--dt SECONDS --ignore-time", "--dt 1 --ignore-time",
    ),
    "a step back": (
        csv([f"{k - 30 * (k > 90)},{k % 7},{k % 5}" for k in ROWS]),
        "--dt SECONDS --ignore-time",
        "--dt 1 --ignore-time",
    ),
    "irregular": (
        csv([f"{k**1.5},{k % 7},{k % 5}" for k in ROWS]), "--dt SECONDS --ignore-time", "--dt 1 --ignore-time",
    ),
    "no times": (csv([f"{k % 7},{k % 5}" for k in ROWS], "OP,PV"), "--dt SECONDS", "--dt 1"),
    "no such dt": (csv([f"{k},{k % 7},{k % 5}" for k in ROWS]), None, "--dt 3 --ignore-time"),
    "a missing time": (csv([f"{k if k != 9 else ''},{k % 7},{k % 5}" for k in ROWS]), "--dt SECONDS", "--dt 1"),
    "no date": (
        csv([f"2024-02-30 10:00:{k % 60},{k % 7},{k % 5}" for k in ROWS]),
        "--dt SECONDS --ignore-time",
        "--dt 1 --ignore-time",
    ),
    "two set points": (csv([f"{k},{k % 7},{k % 5},1,2" for k in ROWS], "time,OP,PV,SP (a),SP (b)"), "rename", None),
}  # fmt: skip


@pytest.mark.sampled(15)
@pytest.mark.parametrize("case", FOLLOWED)
@pytest.mark.parametrize("command", ["check", "online"])
def test_a_hint_leads_on(capsys, tmp_path, command, case):
    content, hint, words = FOLLOWED[case]
    path = tmp_path / "loop.csv"
    path.write_text(content)
    more = () if command == "check" else ("--orders", "1,0,1", "--start-samples", "200", "--no-follow")
    if hint is not None:
        said = said_by(capsys, command, path, *more)
        assert hint in said or (command == "online" and not said)  # a few bad times are passed over there
        for line in said.splitlines()[1:]:
            assert said_by(capsys, *shlex.split(line)[1:]) == ""
    if words is not None:
        assert said_by(capsys, command, path, *more, *shlex.split(words)) == ""


def test_newest_row_first_is_not_to_be_ignored_while_it_grows(capsys, tmp_path):
    path = tmp_path / "loop.csv"
    path.write_text(csv([f"{500 - k},{k % 7},{k % 5}" for k in ROWS]))
    said = said_by(capsys, "online", path, "--orders", "1,0,1", "--no-follow")
    assert "sort the rows by time, oldest first" in said
    assert "--ignore-time" not in said
    assert said_by(capsys, "check", path) == ""


def test_json_has_the_same_words(capsys, tmp_path):
    path = tmp_path / "loop.csv"
    path.write_text(csv([f"{k % 7},{k % 5}" for k in ROWS], "OP,PV"))
    with pytest.raises(SystemExit):
        main(["check", str(path), "--json"])
    out, error = capsys.readouterr()
    assert json.loads(out)["error"] == TimeError.__name__
    assert f"error: {json.loads(out)['message']}\n" == error
    assert "--dt SECONDS" in error


@pytest.fixture
def offering():
    """Sets the options of the command that runs."""
    before = OFFERED.get()
    yield lambda *options: OFFERED.set(frozenset(options))
    OFFERED.set(before)


def test_a_pair_of_limits_can_be_pasted(offering):
    offering("--span")
    error = ParameterError.expected("limits", "none", "give span=(low, high)").leads_on({"span": (-1.5, 3.0)})
    typed = ["export", "fit.json", "--span", "0", "100", "--out", "a"]
    assert commands_on(error, typed) == ["lostmotion export fit.json --out a --span -1.5 3"]


def test_the_clamps_of_a_command_that_reads_records_are_its_span(offering):
    offering("--op-span")
    assert as_options("give span=(low, high)") == "give --op-span LOW HIGH"
