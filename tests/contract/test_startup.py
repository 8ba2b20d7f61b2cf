"""What is loaded when: nothing heavy before it is needed; and laziness changes no name."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.cli.commands import COMMANDS

HEAVY = ("numpy", "numba", "polars", "scipy", "matplotlib", "control", "narwhals", "jinja2")


def loaded_after(code, *names):
    """Those of the modules that are in memory after the code."""
    program = f"{code}\nimport sys\nprint(*({set(names)!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1].split()


def test_the_package_alone_loads_nothing_heavy():
    assert loaded_after("import lostmotion; dir(lostmotion); lostmotion.__version__", *HEAVY, "typer") == []


@pytest.mark.long
@pytest.mark.parametrize(
    "code",
    [
        "lm.RecursiveIV; assert callable(lm.identify)",
        "import lostmotion.design.request; assert callable(lm.design)",
        "from lostmotion.diagnose import Diagnosis; assert callable(lm.diagnose)",
        "from lostmotion import *; assert PI is lm.PI and identify is lm.identify",
        "assert lm.signals.prs(5, 0, 1, 2, 0).size == 5 and lm.platforms.level_tank().linear.dt",
        "assert lm.files.write_columns and lm.evaluate.random_loop and lm.plot.fit_figure",
    ],
)
def test_names_are_what_they_were_whichever_comes_first(code):
    loaded_after(f"import lostmotion as lm\n{code}")


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="identity"):
        lm.identity  # noqa: B018


def test_the_stub_and_the_package_list_the_same_names():
    stub = ast.parse(Path(lm.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    listed = next(node.value for node in stub.body if isinstance(node, ast.Assign))
    assert sorted(ast.literal_eval(listed)) == sorted(lm.__all__)
    assert set(lm.__all__) | {"__version__", "__doc__"} <= set(dir(lm))


@pytest.mark.parametrize("words", ["--help", "--version"])
def test_help_and_version_load_no_command(words):
    code = f"from lostmotion.cli import main\ntry: main(['{words}'])\nexcept SystemExit as end: assert not end.code"
    commands = [f"lostmotion.cli.{name.replace(chr(45), chr(95))}" for name in COMMANDS]
    assert loaded_after(code, *HEAVY, *commands) == []


@pytest.mark.parametrize("name", ["check", "diagnose", "identify", "export", "paper"])
def test_a_command_is_read_without_what_it_needs_to_work(name):
    assert loaded_after(f"import lostmotion.cli.{name}", *HEAVY) == []


def test_check_works_without_numba(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time_s,OP,PV\n" + "".join(f"{k},{50 + k % 97},{k % 89}\n" for k in range(2000)))
    code = f"from lostmotion.cli import main\ntry: main(['check', {str(path)!r}])\nexcept SystemExit: pass"
    assert loaded_after(code, "numba", "matplotlib", "control") == []
