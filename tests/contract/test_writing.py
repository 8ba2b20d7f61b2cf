"""Nobody writes a file but the writer, and nothing in the core runs what others wrote."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest

CORE = Path(__file__).resolve().parents[2] / "src" / "lostmotion"
FILES = sorted(CORE.rglob("*.py"))
WRITERS = {
    "write_text", "write_bytes", "writelines", "savefig", "tofile", "touch", "mkdir", "makedirs", "rename", "renames",
    "replace", "unlink", "rmdir", "symlink_to", "hardlink_to", "link", "symlink", "truncate", "write_csv", "dump",
    "write_parquet", "sink_csv", "sink_parquet", "save", "savez", "savetxt", "to_csv", "to_parquet", "savemat",
    "copy2", "copyfile", "copytree", "rmtree", "mkstemp", "mkdtemp", "NamedTemporaryFile", "chmod",
}  # fmt: skip
NOT_FILES = {  # what has such a name and writes no file, or goes through the writer
    "files/write.py": {"write_parquet", "write_csv", "write_bytes"},  # into memory, then the writer
    "files/results.py": {"write_bytes", "write_text"}, "files/text.py": {"rename"},  # columns of a frame
    "files/folders.py": {"mkdir", "rmdir"},  # folders of what is written
    "files/joined.py": {"rename"}, "files/long.py": {"rename"},
    "online/service.py": {"write_bytes"}, "files/child.py": {"write_csv"},
    "live/recorder.py": {"write_parquet", "write_bytes"},  # into memory, then the writer
    "live/run.py": {"save"},  # of a service, whose state goes through the writer
    "cli/output.py": {"savefig", "write_bytes", "write_text"}, "cli/paper.py": {"write_text"},
    "paper/page.py": {"savefig"}, "identify/recursive/archive.py": {"savez"}, "cli/identify.py": {"save"},
    "web/plant/overview.py": {"link"}, "web/plant/pages.py": {"link"},  # of a query: an address
    "web/worker/tasks.py": {"write_bytes"},
    # folders of the page itself, with names that it has made up: what was dropped, what was read for a trend
    "web/desk/desk.py": {"mkdir", "mkdtemp", "rmtree", "unlink"}, "web/server/browser.py": {"mkstemp"},
    "web/trend/loop_records.py": {"mkdtemp", "rmtree", "write_bytes"},
    "web/desk/workspace.py": {"mkdir", "mkdtemp", "rmtree"},
    "live/demo_files.py": {"mkdir"},  # the folder that --files names, and the door in it
    "live/supervision/handed_over.py": {"rename", "unlink"},  # a request is taken once, or taken back
    # what Numba keeps for the kernels, and folders of older sources there; below all that could write for it
    "kernels/numba_cache.py": {"mkdir", "rmtree"},
}  # fmt: skip
NOT_FILES_BUT_OPENED = {  # the null device, a pipe, folders for their locks, the worker's own output
    "cli/closed_output.py", "files/alone.py", "files/child.py", "files/undamaged.py", "web/worker/work.py",
    "audit/runner/limit.py",  # the null device
    "live/audit_log.py",  # lines are appended, each on the disk before anything is sent
    "web/desk/desk.py",  # what is dropped is streamed into a new file
    "web/server/browser.py",  # the way of the token to the browser
}  # fmt: skip
RUNS = {"eval", "exec", "compile", "__import__", "system", "popen", "Popen", "check_output", "check_call", "urlopen"}
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


def for_writing(node, name, on):
    """A call of open() that is not for reading alone."""
    words = [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
    words += [word.value.value for word in node.keywords if word.arg == "mode" and isinstance(word.value, ast.Constant)]
    if on == "os" or name == "fdopen":
        return True
    return name == "open" and any(isinstance(word, str) and set(word) & set("wxa+") and len(word) < 4 for word in words)


def test_files_are_written_by_the_writer_alone():
    faults = []
    for path in FILES:
        name = path.relative_to(CORE).as_posix()
        allowed = NOT_FILES.get(name, set())
        for called, node, on in calls(path):
            opened = name not in NOT_FILES_BUT_OPENED and called in ("open", "fdopen") and for_writing(node, called, on)
            if name != "files/writer.py" and (
                opened or (called in WRITERS - allowed and not _harmless(called, node, on))
            ):
                faults.append(f"{name}:{node.lineno} {called}()")
    assert not faults, f"files are written by files/writer.py: {faults}"


def _harmless(called, node, on):
    """Methods of texts and dataclasses, of the command line's own output, and of results."""
    if called == "replace" and on != "os":
        return len(node.args) != 1 or bool(node.keywords) or on == ""
    return on in ("output", "self", "self.kept")


PROCESSES = {  # this Python and a script or module of ours: no word of it is from outside
    "files/reader_process.py": {"subprocess", "Popen"}, "web/worker/handle.py": {"subprocess", "Popen"},
    "audit/runner/limit.py": {"ctypes"},  # Python's own function that interrupts a thread of this process
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
            if called in RUNS - PROCESSES.get(name, set()) and on != "re"
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


def test_the_one_process_is_this_python_and_a_script_of_ours():
    """Its command is a list without a shell; the bytes of files are its standard input alone."""
    path = CORE / "files" / "reader_process.py"
    (run,) = [node for called, node, on in calls(path) if on == "subprocess" and called == "Popen"]
    words = {word.arg: ast.unparse(word.value) for word in run.keywords}
    assert "shell" not in words
    assert words["stdin"] == "subprocess.PIPE"
    (command,) = [
        ast.unparse(node.value)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == ast.unparse(run.args[0])
    ]
    assert command == "[sys.executable, '-s', '-P', '-B', _CHILD, _HOW]"
    kinds = {
        ast.unparse(node.args[0])
        for one in FILES
        for called, node, _ in calls(one)
        if called in ("leaves_apart", "_answer") and one.parent.name == "files"
    }
    assert kinds == {"SHEETS", "HDF5", "PIECES", "kind.lower()", "kind"}


def test_the_worker_of_the_page_is_this_python_and_a_module_of_ours():
    """Its command is a list without a shell; tasks are lines of its standard input."""
    path = CORE / "web" / "worker" / "handle.py"
    (run,) = [node for called, node, on in calls(path) if called == "Popen"]
    assert "shell" not in {word.arg for word in run.keywords}
    assert ast.unparse(run.args[0]) == "command()"
    (made,) = [
        node
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and node.name == "command"
    ]
    assert ast.unparse(made.body[-1]) == "return [sys.executable, '-P', '-m', 'lostmotion.web.worker.work']"


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


CAUGHT = (
    "open(p, 'w')", "p.open('xb')", "open(p, mode='a')", "os.open(p, 1)", "p.write_text('')", "os.replace(a, b)",
    "beside.replace(target)", "figure.savefig(p)", "frame.write_csv(p)",
)  # fmt: skip


@pytest.mark.parametrize("code", CAUGHT)
def test_the_search_finds_what_it_is_for(code, tmp_path):
    path = tmp_path / "a.py"
    path.write_text(code)
    ((called, node, on),) = calls(path)
    assert for_writing(node, called, on) or (called in WRITERS and not _harmless(called, node, on))
