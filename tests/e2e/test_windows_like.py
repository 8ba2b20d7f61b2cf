"""The main jobs in a Python from which POSIX is taken: what Windows lacks is found before somebody there finds it.

What is emulated, and what is not, says ``tests/support/windows_like/sitecustomize.py``.
"""

import gzip
import http.cookiejar
import json
import os
import subprocess
import sys
import urllib.request

import pytest

import lostmotion as lm
from lostmotion.files.tag_file import tag_file
from tests.support.hostile_files import bases
from tests.support.patience import LONG, in_time, until
from tests.support.places import ROOT

LIKE_WINDOWS = ROOT / "tests" / "support" / "windows_like"
TAGS = ("CON", "AUX", "FIC:101")  # names that no file has there


@pytest.fixture(scope="module")
def environment():
    paths = os.pathsep.join(map(str, (LIKE_WINDOWS, ROOT / "src", ROOT)))
    return {**os.environ, "PYTHONPATH": paths, "PYTHONIOENCODING": "cp1252"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Records with the ends of line of Windows."""
    here = tmp_path_factory.mktemp("plant")
    raw = lm.datasets.path("FIC-101").read_bytes()
    (here / "a.csv.gz").write_bytes(raw)
    lines = gzip.decompress(raw).decode().splitlines()
    (here / "a.csv").write_bytes("".join(f"{line}\r\n" for line in lines).encode())
    (here / "a.xlsx").write_bytes(bases("xlsx")[0])
    cells = [line.split(",") for line in lines]
    rows = [[row[0], *(row[-1], row[-2]) * len(TAGS)] for row in cells]
    rows[0] = ["Time", *(f"{tag}.{signal}" for tag in TAGS for signal in ("OP", "PV"))]
    (here / "plant.csv").write_bytes("".join(f"{','.join(row)}\r\n" for row in rows).encode())
    return here


@pytest.fixture(scope="module")
def run(folder, environment):
    def command(*words, codes=(0,)):
        given = [sys.executable, "-P", "-m", "lostmotion", *words]
        done = subprocess.run(given, cwd=folder, env=environment, capture_output=True, timeout=LONG, check=False)
        assert done.returncode in codes, done.stderr.decode("cp1252")
        return done.stdout.decode("cp1252")

    return command


def test_python(folder, environment):
    words = [sys.executable, "-P", str(LIKE_WINDOWS / "use.py")]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, timeout=LONG, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


@pytest.mark.long
def test_from_a_record_to_exported_code(run, folder):
    assert "stiction" in run("diagnose", "a.csv", "--out", "d.json", "--report", "d.html", codes=(1,))
    run("identify", "a.csv", "--out", "f.json", codes=(0, 1))
    words = ("export", "f.json", "--name", "FY_101", "--date", "2026-01-31", "--out", "fy")
    for more in ((), ("--force",)):
        assert "all flags identical" in run(*words, "--accept", "a trial", *more)
    assert len(list((folder / "fy").iterdir())) == 3
    assert "device of Windows" in _refused(
        run, "export", "f.json", "--name", "AUX", "--date", "2026-01-31", "--out", "x"
    )


def _refused(run, *words):
    with pytest.raises(AssertionError) as error:
        run(*words)
    return str(error.value)


@pytest.mark.long
def test_an_audit_of_tags_that_no_file_can_be_called_after(run, folder):
    words = ("--workers", "2", "--store", "p.db", "--report", "r.html", "--report-loops", "loops", "--table", "t.csv")
    said = json.loads(run("audit", "plant.csv", *words, "--json", codes=(1,)))
    assert [row["error"] or None for row in said["assessments"]] == [None] * 3
    assert sorted(path.name for path in (folder / "loops").iterdir()) == sorted(tag_file(tag, ".html") for tag in TAGS)
    assert "FIC:101" in run("audit", "p.db", "--show", codes=(1,))


def test_a_loop_in_service_goes_on_from_its_state(run, folder):
    words = ("online", "a.csv", "--no-follow", "--orders", "1,0,1", "--state", "a.state", "--start-samples", "300")
    first, second = (run(*words, codes=(0, 1)).splitlines() for _ in range(2))
    assert len(first) > len(second) > 0
    assert json.loads(second[0])["sample"] == 2000
    assert sorted(path.name for path in folder.glob("*a.state*")) == [".a.state.lock", "a.state"]


@pytest.mark.long
def test_the_page_diagnoses_a_record(folder, environment):
    command = [sys.executable, "-P", "-m", "lostmotion", "serve", "a.csv", "--no-open"]
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)
    with in_time(process), process.stdout:
        try:
            address = process.stdout.readline().strip()
            jar = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
            browser = urllib.request.build_opener(urllib.request.ProxyHandler({}), jar)
            assert browser.open(address, timeout=LONG).status == 200
            base = address.partition("/?")[0]
            until(lambda: json.load(browser.open(f"{base}/api/v1/files", timeout=LONG))[0]["verdict"] == "stiction")
        finally:
            process.terminate()
            process.wait(LONG)
