"""Files that could not be written are refused before any work; what cannot be written afterwards loses no result."""

import json

import pytest

import lostmotion as lm
from lostmotion import extras
from lostmotion.errors import FileAccessError
from lostmotion.files import writer
from tests.support import commands_that_write as commands
from tests.support.command import run

RECORD = "t_s,OP,PV\n" + "".join(f"{k},{(k // 9) % 7},{(k * k) % 11}\n" for k in range(300))
FIGURES = {
    "identify": ["identify", "a.csv"],
    "diagnose": ["diagnose", "a.csv"],
    "diagnose --same-loop": ["diagnose", "--same-loop", "a.csv", "b.csv"],
    "simulate": ["simulate", *commands.LOOP, *commands.RUNS],
    "design": ["design", *commands.ZONE, *commands.TEST],
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with two records, in which no work may begin."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(RECORD)

    def never(*_, **__):
        pytest.fail("work was done before the file was refused")

    for verb in ("identify", "diagnose", "compensation_study", "design"):
        monkeypatch.setattr(lm, verb, never)
    return tmp_path


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize(
    ("asked", "said"), [("keep", "png, pdf or svg"), ("f.xyz", "png, pdf or svg"), ("keep.png", "--force")]
)
def test_a_figure_is_refused_before_the_work(capsys, here, name, asked, said):
    (here / "keep.png").write_bytes(b"kept")
    code, out, error = run(capsys, *FIGURES[name], "--figure", asked)
    assert (code, out) == (1, "")
    assert error.startswith("error: expected")
    assert said in error
    assert error.count("\n") == 1
    assert (here / "keep.png").read_bytes() == b"kept"
    assert {path.name for path in here.iterdir()} == {"a.csv", "b.csv", "keep.png"}


@pytest.mark.parametrize("name", FIGURES)
def test_without_the_package_that_draws_no_work_is_done(capsys, here, monkeypatch, name):
    monkeypatch.setattr(extras, "find_spec", lambda _: None)
    code, out, error = run(capsys, *FIGURES[name], "--figure", "new.png")
    assert (code, out) == (1, "")
    assert error.endswith('run: pip install "lostmotion[plot]"\n')
    assert {path.name for path in here.iterdir()} == {"a.csv", "b.csv"}


def test_every_command_with_a_figure_is_looked_at():
    with_figure = {name.split()[0] for name in commands.writing(commands.Given(*"abcde")) if "--figure" in name}
    assert with_figure == {name.split()[0] for name in FIGURES}


@pytest.fixture
def full(monkeypatch):
    """A disk without room, which is seen only when bytes are put on it."""

    def no_room(draft, data):
        with writer.write_errors(draft.target, len(data)):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(writer._Draft, "fill", no_room)


@pytest.mark.parametrize("as_json", [False, True])
def test_a_full_disk_takes_no_result(capsys, tmp_path, full, as_json):
    (tmp_path / "a.csv").write_text(RECORD)
    words = ["identify", tmp_path / "a.csv", "--orders", "1,0,1", "--noise", "white", "--nonlinearity", "none"]
    code, out, error = run(capsys, *words, "--out", tmp_path / "a.json", *(["--json"] if as_json else []))
    assert code == 1
    assert error.startswith("error: expected room for")
    assert error.count("\n") == 1
    assert "No space left on device" in error
    if as_json:
        assert "status" in json.loads(out)  # one object: the result, and not the error after it
    else:
        assert len(out.splitlines()) > 3
    assert not (tmp_path / "a.json").exists()


def test_a_full_disk_ends_no_batch(capsys, tmp_path, full):
    for name in ("a", "b"):
        (tmp_path / f"{name}.csv").write_text(RECORD)
    words = ["--orders", "1,0,1", "--noise", "white", "--nonlinearity", "none", "--json", "--out", tmp_path]
    code, out, error = run(capsys, "identify", tmp_path / "a.csv", tmp_path / "b.csv", *words)
    assert code == 1
    assert len(json.loads(out)) == 2
    assert error.count("error: ") == 1


def test_what_could_not_be_kept_of_one_is_kept_with_the_next(tmp_path, monkeypatch):
    from lostmotion.cli.several import each

    class Result:
        def summary(self):
            return "fine"

        def to_dict(self):
            return {"fine": True}

    kept = []

    def keep(data):
        if len(data) == 1:
            raise FileAccessError("no room")
        kept.append(list(data))

    files = [tmp_path / name for name in ("a", "b")]
    found = each(files, lambda _: Result(), lambda *_: "", quiet=False, keep=keep)
    assert [one.result is not None for one in found] == [True, True]
    assert [one.unwritten for one in found] == [None, None]
    assert len(kept[-1]) == 2
