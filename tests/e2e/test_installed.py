"""What somebody has who installs the wheel: plain, and with each extra alone. The suite has all of them.

One test, so that one worker makes the environments.
"""

from __future__ import annotations

import shutil
import subprocess
import zipfile

import numpy as np
import pytest

from lostmotion.extras import EXTRAS
from lostmotion.files import write_columns
from lostmotion.simulate import routine_operation
from tests.support.installed import Environment, build_wheel

NAMED = 'pip install "lostmotion[{}]"'
WORK = {
    "check": ("check", "{loop}"),
    "diagnose": ("diagnose", "{loop}", "--out", "diagnosis.json", "--report", "report.html"),
    "compensate": ("compensate", "{loop}", "--fit", "{fit}", "--out", "compensated.csv"),
    "simulate": ("simulate", "{fit}", "--kp", "0.4", "--ki", "0.1", "--sp-step", "1", "--op-span", "-10", "10"),
    "design": ("design", "--fit", "{fit}", "--op-limits", "-5", "5", "--duration", "60", "--out", "test.csv"),
    "export": ("export", "{fit}", "--name", "LY_101", "--date", "2026-01-31", "--span", "-10", "10", "--out", "block"),
    "online": ("online", "-", "--orders", "3,2,3"),
    "solve": ("solve", "{loop}", "--out", "block.json"),
    "demo-plant": ("demo-plant", "plant", "--loops", "2", "--days", "0.05", "--faults", "1", "--format", "csv"),
    "warm-up": ("warm-up", "--help"),
    "request": ("request", "--help"),
    "paper": ("paper", "--help"),
}
LACKING = {
    "audit": ("audit", ("audit", "{folder}")),
    "show": ("audit", ("audit", "--show", "plant.db")),
    "serve": ("web", ("serve", "--no-open", "--port", "0")),
    "live": ("live", ("live", "opc.tcp://127.0.0.1:1", "--op", "a", "--pv", "b", "--orders", "1,0,1", "--dt", "1")),
    "discover": ("live", ("live", "--discover", "opc.tcp://127.0.0.1:1", "--insecure")),
    "demo-live": ("live", ("demo-live", "--port", "0", "--seconds", "0")),
    "figure": ("plot", ("identify", "{loop}", "--nonlinearity", "none", "--figure", "a.png")),
    "database": ("sql", ("check", "postgresql://reader@127.0.0.1:1/plant", "--query", "SELECT 1")),
    "cluster": ("audit", ("audit", "{folder}", "--engine", "dask")),
}  # fmt: skip
CALLS = {
    "plot": "lm.read_loop(loop).plot().savefig('a.png')",
    "control": "lm.LinearModel((-0.5,), (1.0,), 0, 1.0).to_control()",
    "excel": "from lostmotion.extras import need_extra; need_extra('excel')",
    "matlab": "from lostmotion.extras import need_extra; need_extra('matlab')",
    "sql": "from lostmotion.extras import extra\nwith extra('sql'): import sqlalchemy",
    "audit": "print(lm.audit(folder, 'plant.db', engine='inline').summary())",
    "postgres": "import psycopg",
    "cluster": "import lostmotion.audit.runner.engine.dask_engine",
    "web": "import lostmotion.web.server.serve, lostmotion.web.app",
    "live": "import lostmotion.live.opcua.link, lostmotion.live.opcua.demo_server",
}
# as they are looked for by a worker process, or by modules that only a command imports: there the command says it
WITHOUT_A_SENTENCE = {"postgres", "cluster", "web", "live"}


@pytest.fixture
def place(tmp_path):
    """Folder for a gigabyte, removed at the end."""
    yield tmp_path
    shutil.rmtree(tmp_path, ignore_errors=True)


def record(place):
    """A record of a level tank in routine operation."""
    made = routine_operation(1500, drift="mild", seed=7)
    columns = {"time_s": made.time, "SP": made.reference, "PV": made.measured, "OP": made.command}
    (place / "records").mkdir()
    return write_columns(
        place / "records" / "LIC-101.csv", {name: np.round(values, 5) for name, values in columns.items()}
    )


def test_the_wheel_in_environments_of_its_own(subtests, place):
    wheel, loop, fit = build_wheel(place / "wheel"), record(place), place / "LIC-101.json"
    with subtests.test("the page has what it draws with"):
        if shutil.which("npm") is not None:  # a build without it has a page that draws trends as SVG
            names = {name.rpartition("/")[2] for name in zipfile.ZipFile(wheel).namelist()}
            assert {"uPlot.iife.min.js", "uPlot.min.css"} <= names
    (place / "home").mkdir()
    plain = Environment(place / "plain", place / "home")
    plain.install(str(wheel))
    with subtests.test("a first fit compiles into the cache folder of the user"):
        done = plain.command("identify", loop, "--nonlinearity", "dead zone", "--out", fit)
        assert done.returncode == 0, done.stderr
        compiled = {path.suffix for path in (plain.home / "cache" / "lostmotion").rglob("*") if path.is_file()}
        assert compiled == {".nbi", ".nbc"}
        assert not list(plain.site.rglob("*.nbi"))
    names = {"loop": loop, "fit": fit, "folder": loop.parent}
    for name, words in WORK.items():
        with subtests.test("a command that needs no extra", command=name):
            done = plain.command(*(word.format(**names) for word in words), cwd=place, given=loop.read_text())
            assert done.returncode in (0, 1), done.stderr
            assert "No module" not in done.stderr
            assert "pip install" not in done.stderr
            assert done.stdout
    for name, (extra, words) in LACKING.items():
        with subtests.test("a command that needs an extra", command=name):
            done = plain.command(*(word.format(**names) for word in words), cwd=place)
            assert done.returncode in (1, 2)
            assert NAMED.format(extra) in done.stderr
            assert "No module" not in done.stderr
            assert len(done.stderr.strip().splitlines()) == 1
    for name in EXTRAS:
        with subtests.test("an extra alone", extra=name):
            one_extra(plain, place, name, f"loop, folder = {str(loop)!r}, {str(loop.parent)!r}\n{CALLS[name]}")


def one_extra(plain, place, name, call):
    """What an extra is for works with it, and fails with its name without it."""
    call = f"import lostmotion as lm\n{call}"
    lacking = plain.run("-c", call, cwd=place)
    assert lacking.returncode != 0
    assert name in WITHOUT_A_SENTENCE or NAMED.format(name) in lacking.stderr
    environment = Environment(place / name, plain.home, beside=plain)
    environment.install(f"lostmotion[{name}]")
    done = environment.run("-c", call, cwd=place)
    assert done.returncode == 0, done.stderr
    if name == "web":
        serves(environment)
    shutil.rmtree(environment.folder)


def serves(environment):
    words = [str(environment.python), "-m", "lostmotion", "serve", "--no-open", "--port", "0"]
    process = subprocess.Popen(words, cwd=environment.home, stdout=subprocess.PIPE, text=True)
    try:
        assert "http://127.0.0.1:" in process.stdout.readline()
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()
