"""Parts of the command line: groups of options, the table of commands, where results go, numbers from a file."""

import inspect
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
import typer

import lostmotion as lm
from lostmotion.cli import app, main
from lostmotion.cli.commands import COMMANDS, Loaded, _function
from lostmotion.cli.groups import spread
from lostmotion.cli.output import OutputOptions, places
from lostmotion.cli.paper import METHODS
from lostmotion.cli.rough_model import KEYS
from tests.support.refusals import refusal


@dataclass(frozen=True)
class Size:
    width: Annotated[float, typer.Option("--width")] = 1.0
    dt: Annotated[float | None, typer.Option("--dt", help="of the size")] = None


@dataclass(frozen=True)
class Clock:
    dt: Annotated[float | None, typer.Option("--dt", help="of the clock")] = None
    start: Annotated[int, typer.Option("--start")] = 0


def command(seen: list, name: str = "x", *, size: Size, clock: Clock) -> None:
    """What it does."""
    seen.append((name, size, clock))


def test_a_group_stands_for_its_options_and_shares_those_of_one_name():
    whole = spread(command)
    assert list(inspect.signature(whole).parameters) == ["seen", "name", "width", "dt", "start"]
    assert whole.__annotations__["dt"].__metadata__[0].help == "of the size"
    assert whole.__doc__ == "What it does."
    seen = []
    whole(seen=seen, name="y", width=2.0, dt=0.5, start=3)
    assert seen == [("y", Size(2.0, 0.5), Clock(0.5, 3))]


@pytest.mark.parametrize("name", COMMANDS)
def test_the_table_of_commands_is_what_their_docstrings_say(name):
    function = _function(name)
    assert COMMANDS[name] == inspect.getdoc(function).splitlines()[0]


@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_has_two_options_of_one_name_or_too_many_parameters(name):
    function = _function(name)
    assert len(inspect.signature(function).parameters) <= 12
    words = [word for parameter in Loaded()[name].params for word in parameter.opts if word.startswith("--")]
    assert len(set(words)) == len(words)


def test_commands_are_those_of_the_table():
    assert sorted(typer.main.get_command(app).commands) == sorted(COMMANDS)
    with pytest.raises(KeyError):
        Loaded()["solve it"]


def test_keys_of_a_model_file_are_options():
    options = {one.name for name in ("simulate", "design") for one in Loaded()[name].params}
    assert set(KEYS) <= options


def test_methods_of_the_paper_are_those_of_the_library():
    from lostmotion.paper.estimation import METHODS as METHODS_OF_THE_LIBRARY

    assert METHODS == METHODS_OF_THE_LIBRARY


def test_results_of_several_files_go_into_a_folder(tmp_path):
    one, two = Path("a/FC7.csv"), Path("b/FC8.csv")
    assert places([one], tmp_path / "x.json", "results", ".json") == {one: tmp_path / "x.json"}
    assert places([one, two], None, "results", ".json") == {}
    found = places([one, two], tmp_path, "results", ".json")
    assert found == {one: tmp_path / "FC7.json", two: tmp_path / "FC8.json"}
    assert places([one, two], tmp_path / "new", "results", ".json")[one] == tmp_path / "new" / "FC7.json"
    alike = [one, Path("b/FC7.csv")]
    assert "different names" in refusal(lm.FileAccessError, places, alike, tmp_path, "results", ".json")


def test_a_figure_that_cannot_be_drawn_is_refused_before_any_work(tmp_path):
    OutputOptions().refuse(None, figures=(None, tmp_path / "a.PNG"))
    said = refusal(lm.FileAccessError, OutputOptions().refuse, figures=(tmp_path / "a.bmp",))
    assert "png, pdf or svg" in said


@pytest.mark.parametrize("name", ["diagnose", "check", "design", "export", "online"])
def test_help_of_two_numbers_says_that_a_blank_is_between_them(name, capsys):
    with pytest.raises(SystemExit):
        main([name, "--help"])
    text = capsys.readouterr().out
    assert "LOW HIGH" in text
    assert "float,float" not in text


@pytest.mark.parametrize("words", [["--op-span", "0", "100"], ["--op-span", "0,100"], ["--op-span=0,100"]])
def test_two_numbers_are_taken_with_a_blank_or_a_comma(words, capsys, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time_s,OP,PV\n" + "".join(f"{row},{row % 7 + 40},{row % 9}\n" for row in range(400)))
    with pytest.raises(SystemExit):
        main(["check", str(path), *words])
    assert "% of span" in capsys.readouterr().out
