"""Every command on a wide and on a packed file in 3 GB of address space: a result, or one line, and no abort."""

import gzip
import subprocess
import sys

import numpy as np
import pytest

from tests.support.patience import LONG

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(sys.platform != "linux", reason="ulimit -v limits the memory of a process on Linux only"),
]

LIMIT = 3_000_000  # kB
ROWS, COLUMNS = 100_000_000, 9_999
COMMANDS = {
    "check": [],
    "diagnose": [],
    "identify": ["--nonlinearity", "dead zone"],
    "compensate": ["--left", "49", "--right", "51", "--out", "o.csv", "--force"],
    "online": ["--no-follow", "--orders", "1,0,1"],
    "solve": [],
    "audit": ["--workers", "1"],
}
CASES = [(command, "packed.csv.gz") for command in COMMANDS]
# the others look at each of its 4,999 loops, which takes minutes
CASES += [(command, "wide.csv") for command in COMMANDS if command not in ("diagnose", "audit")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    here = tmp_path_factory.mktemp("memory")
    with gzip.open(here / "packed.csv.gz", "wb", compresslevel=6) as stream:
        stream.write(b"OP,PV\n")
        for _ in range(100):
            stream.write(b"1,1\n" * (ROWS // 100))
    numbers = np.random.default_rng(0).normal(50.0, 5.0, (20, COLUMNS - 1))
    names = ",".join(f"L{k // 2}.{('OP', 'PV')[k % 2]}" for k in range(COLUMNS - 1))
    rows = (f"2026-01-01 00:00:{k:02d},{','.join(f'{v:.2f}' for v in row)}" for k, row in enumerate(numbers))
    (here / "wide.csv").write_text("\n".join([f"Time,{names}", *rows]), encoding="utf-8")
    return here


@pytest.mark.parametrize(("command", "file"), CASES)
def test_it_ends_in_a_result_or_a_line(folder, command, file):
    given = [command, file, *(["--dt", "1"] if file == "packed.csv.gz" else []), *COMMANDS[command]]
    limited = ["bash", "-c", f'ulimit -v {LIMIT}; exec "$@"', "bash", sys.executable, "-P", "-m", "lostmotion", *given]
    done = subprocess.run(limited, cwd=folder, capture_output=True, text=True, timeout=LONG, check=False)
    assert done.returncode in (0, 1, 2)
    assert "Traceback" not in done.stderr
    assert len([line for line in done.stderr.splitlines() if line.startswith("error")]) <= 1
