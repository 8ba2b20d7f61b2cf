"""Every message of the readers is provoked here, and what it says to type is typed.

A new message makes `test_no_message_is_left` fail with its place: add a case that provokes it to
`tests/support/reader_*.py`.
"""

import re
import shlex
import sys
from importlib.util import find_spec

import pytest

from lostmotion.cli.wording import FLAGS, OPTIONS
from lostmotion.errors import LostMotionError
from lostmotion.files import read_loop
from tests.e2e.test_commands import run
from tests.support.messages import PACKAGE, places_in, ran, refusals_in
from tests.support.packed_files import workbook as spreadsheet
from tests.support.reader_calls import OTHERS, PATCHED, checked, unusable
from tests.support.reader_sources import SOURCES, made
from tests.support.reader_texts import TEXTS, rows, stored
from tests.unit.files.test_packed import ROWS

NOT_READERS = (  # they write, or read what we have written
    "write.py",
    "results.py",
    "fields.py",
    "schema.py",  # of saved files: tests/properties/test_hostile_json.py and test_hostile_states.py
    "write_errors.py",  # tests/unit/files/test_writer.py
    "writer.py",  # tests/unit/files/test_writer.py
    "apart.py",  # what becomes of a reader in its process: tests/unit/files/test_apart.py
    "reader_process.py",
)
READERS = sorted(f"files/{path.name}" for path in (PACKAGE / "files").glob("*.py") if path.name not in NOT_READERS)
CHECKS = ["records/findings.py", "records/prepared.py", "records/record.py", "records/when.py"]
NEEDS = {  # readers with messages that another package is needed for
    "files/workbook.py": "fastexcel",
    "files/database.py": "sqlalchemy",
}
BOOKS = {
    "a damaged workbook": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
    "two sheets with rows": spreadsheet(ROWS, ROWS),
}
LISTED = ("several loops", "MAT of two loops", "packed records")  # check lists what they hold
FILES = {**dict.fromkeys(TEXTS, stored), **dict.fromkeys(SOURCES, made)}
# What an option is followed by, where the message leaves it open: case -> values in their order; SECONDS are 1.
LEFT_OPEN = {
    "no OP": ["valve"],
    "two that differ in case": ["OUT1"],
    "a name that is not there": ["OP"],
    "one column for two roles": ["PV"],
    "a span turned round": ["0", "100"],
    "a file that contradicts its name": ["FIC101_OP", "FIC101_PV"],
    "no query": ["SELECT * FROM fic101"],
    "no query of an address": ["SELECT * FROM fic101"],
}
OPEN = ("COLUMN", "NAME", "LOW", "HIGH", "SELECT ..")
FLAG = "|".join(FLAGS.values())
OPTION = rf"(?:{FLAG}|--[a-z-]+ (?:'[^']*'|[A-Z]+ [A-Z]+\b|[^\s,;]+))"
TOGETHER = re.compile(rf"{OPTION}(?: (?:and )?{OPTION})*")


def refused(work, *given):
    with pytest.raises(LostMotionError) as caught:
        work(*given)
    return caught.value


def options(settings):
    """Settings of the reader as they are typed; None: there is no option for one of them."""
    words = []
    for name, value in settings.items():
        flag = FLAGS.get((name, str(value)))
        if flag is None and name not in OPTIONS:
            return None
        words += [flag] if flag else [OPTIONS[name], *map(str, value if isinstance(value, tuple) else (value,))]
    return words


def said_to_type(remedy, case):
    """Words of each option, or of several together, that a remedy names."""
    values = iter(LEFT_OPEN.get(case, ()))
    for found in TOGETHER.findall(remedy):
        words = [word for word in shlex.split(found) if word != "and"]
        yield ["1" if word == "SECONDS" else next(values) if word in OPEN else word for word in words]


def commands_in(text):
    return [shlex.split(line.strip())[1:] for line in text.splitlines() if line.startswith("    lostmotion ")]


def assert_reads(capsys, words):
    _, text, error = run(capsys, *words)
    assert error == "", words
    assert re.search(r"holds .*\d+ samples of OP", text), (words, text)


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """Lines that all cases together run, and the errors."""
    found = {}
    with pytest.MonkeyPatch.context() as patch, ran() as lines:
        folder = tmp_path_factory.mktemp("cases")
        for case, put in FILES.items():
            source, settings = put(folder, case)
            found[case] = refused(lambda source=source, settings=settings: read_loop(source, **settings))
        for case, work in OTHERS.items():
            found[case] = refused(work, folder)
        for case, work in PATCHED.items():
            with pytest.MonkeyPatch.context() as inner:
                found[case] = refused(work, folder, inner)
        for case, content in BOOKS.items() if find_spec("fastexcel") else ():
            (folder / "a.xlsx").write_bytes(content)
            found[case] = refused(read_loop, folder / "a.xlsx")
        if find_spec("sqlalchemy"):
            patch.setitem(sys.modules, "psycopg2", None)
            found["no driver"] = refused(lambda: read_loop("postgresql+psycopg2://host/plant", query="SELECT 1"))
        checked()
    return lines(), found


def test_no_message_is_left(seen):
    lines, _ = seen
    files = [file for file in (*READERS, *CHECKS) if file not in NEEDS or find_spec(NEEDS[file])]
    places = [place for file in files for place in places_in(file)]
    assert len(places) > 100
    left = [one for one in places if not lines.get(one.file, set()) & set(range(one.first, one.last + 1))]
    assert [f"{one.file}:{one.first} {one.text}" for one in left] == [], "no case provokes these messages"


def test_no_refusal_of_prepare_is_left():
    left = [text for text in refusals_in("records/findings_words.py") if not any(text.match(one) for one in unusable())]
    assert left == [], "no case provokes these refusals"


def test_messages_say_what_to_do(seen):
    for case, error in seen[1].items():
        message = str(error)
        assert message.split("expected ", 1)[1].count("; ") >= 1 or case == "no such file to follow", (case, message)
        assert ", got " in message, case


@pytest.mark.sampled(27)
@pytest.mark.parametrize("case", [case for case in FILES if case not in LISTED])
def test_what_a_message_says_to_type_works(capsys, tmp_path, case):
    source, settings = FILES[case](tmp_path, case)
    words = options(settings)
    if words is None:
        pytest.skip("no option of the command")
    code, text, error = run(capsys, "check", source, *words)
    assert code in (1, 2)  # a value out of range, or an input that does not exist, is wrong usage
    assert not text
    assert error.startswith("error: expected "), error
    whole = commands_in(error)
    for command in whole:
        assert_reads(capsys, command)
    remedy = error.splitlines()[0].partition("; ")[2]
    typed = list(said_to_type(remedy, case))
    for more in typed:
        assert_reads(capsys, ["check", source, *words, *more])
    assert set(re.findall(r"--[a-z-]+", remedy)) <= {word for line in typed for word in line}, "not typed"


@pytest.mark.parametrize("case", FILES)
def test_settings_that_an_error_carries_work(seen, tmp_path, case):
    source, settings = FILES[case](tmp_path, case)
    for way in getattr(seen[1][case], "ways", ()):
        assert len(read_loop(source, **settings | way)) > 1, way


def test_missing_values_are_kept_where_the_message_says_so(seen, tmp_path):
    case = "missing values that are not wanted"
    assert "read with missing='keep'" in str(seen[1][case])
    source, settings = stored(tmp_path, case)
    assert len(read_loop(source, **settings | {"missing": "keep"})) > 1


@pytest.mark.parametrize("case", LISTED)
def test_loops_are_listed_with_commands_that_work(capsys, tmp_path, case):
    path, settings = stored(tmp_path, case)
    code, text, error = run(capsys, "check", path, *options(settings))
    assert (code, error) == (1, "")
    assert "holds 2 loops:" in text
    one, every = commands_in(text)
    assert_reads(capsys, one)
    assert every == ["diagnose", str(path), *options(settings)]  # run below
    code, _, error = run(capsys, "identify", path, *options(settings))
    assert "; name one: --loop " in error
    commands = commands_in(error)
    assert [command[0] for command in commands] == ["identify"] * 2
    for command in commands:
        assert_reads(capsys, ["check", *command[1:]])  # the loops are too short to be identified


def test_the_command_for_all_loops_takes_them_all(capsys, tmp_path):
    """Loops at rest: nothing is fitted."""
    path = tmp_path / "a.csv"
    at_rest = [f"{line.split(',')[0]},5,1,6,2" for line in rows().splitlines()[1:]]
    path.write_text("\n".join(["time,FIC1.OP,FIC1.PV,FIC2.OP,FIC2.PV", *at_rest, ""]))
    _, every = commands_in(run(capsys, "check", path)[1])
    _, text, error = run(capsys, *every)
    assert error == ""
    assert [line.split()[0] for line in text.splitlines()[:2]] == ["FIC1", "FIC2"]


def test_what_is_to_be_installed_is_offered(seen):
    """Extras that messages name are those of the project."""
    project = (PACKAGE.parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    named = set(re.findall(r"lostmotion\[(\w+)\]", " ".join(map(str, seen[1].values()))))
    assert {"matlab", "sql"} <= named
    assert all(re.search(rf"^{extra} = \[", project, re.MULTILINE) for extra in named)
