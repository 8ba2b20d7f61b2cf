"""Nobody writes a file but the writer, and nothing in the core runs what others wrote."""

import ast
import json
import os
import re
import sys
import tomllib
from subprocess import run

import pytest

from lostmotion.files import folders, writer
from lostmotion.kernels import numba_cache
from lostmotion.web.worker import handle
from lostmotion.workers import isolated, pool
from tests.support.places import ROOT
from tests.support.watched import CHANGES, REACHES, RUNS

CORE = ROOT / "src" / "lostmotion"
FILES = sorted(CORE.rglob("*.py"))
CALLED = {"eval", "exec", "compile", "__import__", "system", "popen", "Popen", "check_output", "check_call", "urlopen"}
MODULES = {"pickle", "marshal", "shelve", "subprocess", "socket", "urllib", "http", "requests", "ctypes", "dill"}


def calls(path):
    """Names of what is called, with the call and, of a method, what it is called on."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            function = node.func
            if isinstance(function, ast.Attribute):
                yield function.attr, node, ast.unparse(function.value)
            elif isinstance(function, ast.Name):
                yield function.id, node, ""


# who writes: results, their folders, what is compiled, the empty folder of workers
BY = {writer.__name__, folders.__name__, numba_cache.__name__, isolated.__name__}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """What each command that writes did outside of its process, as Python reports it."""
    found = tmp_path_factory.mktemp("found") / "done.json"
    words = ["-m", "tests.support.watched_commands", str(tmp_path_factory.mktemp("commands")), str(found)]
    ended = run([sys.executable, "-X", "faulthandler", *words], cwd=ROOT, timeout=500, check=False)
    assert ended.returncode == 0
    return json.loads(found.read_text(encoding="utf-8"))


@pytest.mark.long
def test_files_are_written_by_the_writer_alone(done):
    faults = {
        (name, one["event"], one["what"][0], one["by"][0])
        for name, all_done in done.items()
        for one in all_done
        if one["by"] and not BY & set(one["by"]) and one["event"] in CHANGES | {"open"} and one["what"][0] != os.devnull
    }
    assert not faults
    assert all(any(writer.__name__ in one["by"] for one in all_done) for all_done in done.values()), (
        "the watch is blind"
    )


@pytest.mark.long
def test_commands_reach_nobody_and_start_nothing_but_this_python(done):
    events = [one for all_done in done.values() for one in all_done if one["by"]]
    assert [one for one in events if one["event"] in REACHES] == []
    assert {one["what"][0] for one in events if one["event"] in RUNS} <= {sys.executable}


PROCESSES = {  # this Python and a script or module of ours: no word of it is from outside
    "workers/isolated.py": {"subprocess", "Popen"}, "workers/process.py": {"subprocess"},
    "workers/child.py": {"pickle"}, "workers/pool.py": {"pickle"},  # between two processes of this program
    "workers/interrupt.py": {"ctypes"},  # Python's own function that interrupts a thread of this process
    "web/server/serve.py": {"socket"},  # listens; the core reaches out to nobody
    "live/child_plc.py": {"subprocess", "Popen"},  # on the bench: the command that was typed behind demo-live --plc
}  # fmt: skip


@pytest.mark.long
def test_nothing_runs_what_others_wrote():
    faults = []
    for path in FILES:
        name = path.relative_to(CORE).as_posix()
        faults += [
            f"{name}:{node.lineno} {called}()"
            for called, node, on in calls(path)
            if called in CALLED - PROCESSES.get(name, set()) and on != "re"
        ]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            faults += [
                f"{name}:{node.lineno} {word}"
                for word in names
                if _reaches_out(word) and word not in PROCESSES.get(name, set())
            ]
    assert not faults, faults


def test_readers_are_this_python_and_a_script_of_ours():
    """The bytes of files are their standard input alone."""
    path = CORE / "files" / "reader_process.py"
    (run,) = [node for called, node, _ in calls(path) if called == "Process"]
    assert ast.unparse(run.args[0]) == "['-s', '-B', _CHILD, _HOW]"
    kinds = {
        ast.unparse(node.args[0])
        for one in FILES
        for called, node, _ in calls(one)
        if called in ("leaves_apart", "_answer") and one.parent.name == "files"
    }
    assert kinds == {"SHEETS", "HDF5", "PIECES", "kind.lower()", "kind"}


def test_workers_are_this_python_and_a_module_of_ours():
    """A list without a shell, behind -P; what they are given is no word of it."""
    (run,) = [node for called, node, _ in calls(CORE / "workers" / "isolated.py") if called == "Popen"]
    assert "shell" not in {word.arg for word in run.keywords}
    assert ast.unparse(run.args[0]) == "[sys.executable, '-P', *words]"
    assert pool.WORKER == ("-m", "lostmotion.workers")


def test_the_worker_of_the_page_is_a_module_of_ours():
    """Tasks are messages on its standard input."""
    (run,) = [node for called, node, _ in calls(CORE / "web" / "worker" / "handle.py") if called == "Process"]
    assert ast.unparse(run.args[0]) == "WORKER"
    assert handle.WORKER == ("-m", "lostmotion.web.worker.work")


def test_the_plc_of_the_bench_is_started_without_a_shell_and_by_demo_live_alone():
    path = CORE / "live" / "child_plc.py"
    (run,) = [node for called, node, on in calls(path) if called == "Popen"]
    assert "shell" not in {word.arg for word in run.keywords}
    assert ast.unparse(run.args[0]) == "list(command)"
    users = [one.name for one in FILES if one != path and "child_plc import" in one.read_text(encoding="utf-8")]
    assert users == ["demo_live.py"]


def _reaches_out(module):
    """Taking an address apart opens no connection."""
    return module != "urllib.parse" and module.partition(".")[0] in MODULES


def test_the_page_gives_a_reason_for_every_package_that_it_runs_with():
    page = (CORE.parents[1] / "docs" / "security.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([\w-]+)` \| (always|\[\w+\]) \| ([^|]{20,}) \|$", page, re.MULTILINE)
    project = tomllib.loads((CORE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = {"always": project["dependencies"]}
    wanted |= {f"[{name}]": packages for name, packages in project["optional-dependencies"].items() if name != "dev"}
    named = {(re.match(r"[\w-]+", package)[0], when) for when, packages in wanted.items() for package in packages}
    assert {(package, when) for package, when, _ in rows} == named
    assert len(rows) == len(named)


def test_the_core_imports_nothing_but_these_packages():
    project = tomllib.loads((CORE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    packages = [*project["dependencies"]]
    for name, more in project["optional-dependencies"].items():
        packages += more if name != "dev" else []
    known = {re.match(r"[\w-]+", package)[0].replace("-", "_") for package in packages}
    known |= {
        "lostmotion",
        "llvmlite",
        "markupsafe",
        "dask",
    } | sys.stdlib_module_names  # parts of Numba, Jinja2, distributed
    known |= {"pyarrow", "pandas"}  # used where they are there
    imported = set()
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            imported |= {name.partition(".")[0] for name in names}
    assert imported <= known, imported - known
