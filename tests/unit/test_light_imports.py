"""Reading, checking and preparing a record of usual length takes neither Numba nor the heavy parts of SciPy."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lostmotion
from tests.unit.files.test_follow_like_read_loop import moments

HEAVY = ("numba", "scipy.stats", "scipy.signal", "scipy.optimize", "scipy.io", "matplotlib", "jinja2")
ROWS = 2000
SOURCE = Path(lostmotion.__file__).parent
WORK = """
from lostmotion.files import read_loop
from lostmotion.records import check, prepare
record = read_loop(sys.argv[1])
report, prepared = check(record), prepare(record)
assert len(record) == 2000 and report.usable and prepared.usable, report.summary() + prepared.summary()
print(*(name for name in sys.argv[2:] if name in sys.modules))
"""
# The package without what its __init__ imports: only the rooms that are named.
ALONE = f"""
import sys, types
package = types.ModuleType("lostmotion")
package.__path__ = [{str(SOURCE)!r}]
sys.modules["lostmotion"] = package
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    random = np.random.default_rng(0)
    op, pv = np.cumsum(random.normal(size=(2, ROWS)), axis=1)
    stamps = moments("%Y-%m-%d %H:%M:%S", rows=ROWS)
    lines = [f"{stamps[k]},{op[k]:.4f},{pv[k]:.4f},{k // 500},AUTO" for k in range(ROWS)]
    path = tmp_path_factory.mktemp("light") / "loop.csv"
    path.write_text("\n".join(["time,OP,PV,SP,Mode", *lines, ""]))
    return path


def imported(path, before):
    done = subprocess.run(
        [sys.executable, "-c", before + WORK, str(path), *HEAVY], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_rooms_below_identify(path):
    assert imported(path, ALONE) == []


def test_models_do_without_scipy_signal():
    work = "import lostmotion.models\nprint(*(name for name in sys.argv[1:] if name in sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", ALONE + work, "scipy.signal", "scipy.stats"], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == []


def test_whole_package(path):
    found = imported(path, "import sys\n")
    at_once = subprocess.run(
        [sys.executable, "-c", "import lostmotion, sys; print('numba' in sys.modules)"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    if at_once.stdout.strip() == "True":
        pytest.xfail("lostmotion/__init__.py imports all rooms")
    assert found == []


def test_a_worker_that_screens_loads_no_fit():
    code = "import sys, lostmotion.audit.runner.work, lostmotion.audit.screen.screen; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "lostmotion.diagnose.harris" in loaded
    apart = ("lostmotion.identify", "scipy.signal", "scipy.stats", "scipy.optimize", "sqlalchemy", "jinja2")
    assert not [name for name in apart if name in loaded]


def test_the_page_of_a_store_begins_without_numba():
    code = "import sys, lostmotion.web.server.serve; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    apart = ("numba", "lostmotion.identify", "lostmotion.compensate", "scipy.signal", "scipy.stats", "matplotlib")
    assert not [name for name in apart if name in loaded]
