"""The ST machine of pyplcopen behind ctypes, and exported C behind gcc or the clang that `make plc` has fetched."""

import ctypes
import os
import re
import shutil
import subprocess
from functools import cache

import numpy as np
import pytest

from tests.support.places import ROOT

PLACE = ROOT / ".venv-plc"
PYTHON = PLACE / "bin" / "python"
LIBRARY = PLACE / "machine.so"
SCHEMA = PLACE / "tc6_xml_v201.xsd"


def need(*paths):
    """Skip, with what to do, where `make plc` has not been run; fail in CI."""
    missing = [str(path.relative_to(ROOT)) for path in paths if not path.exists()]
    if missing:
        lacking(f"{', '.join(missing)} not there: run `make plc`")


def lacking(text):
    """Skip, saying so; fail in CI."""
    if os.environ.get("CI"):
        pytest.fail(text)
    pytest.skip(text)


def c_compiler():
    """Path of gcc, else of the clang of .venv-plc."""
    found = shutil.which("gcc") or shutil.which("cc", path=PLACE / "bin")
    return found or lacking("no gcc, and no cc in .venv-plc: run `make plc`")


@cache
def _library():
    library = ctypes.CDLL(str(LIBRARY))
    library.plc_load.restype = ctypes.c_void_p
    library.plc_load.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_int]
    library.plc_free.argtypes = [ctypes.c_void_p]
    library.plc_find.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
    where, rows = np.ctypeslib.ndpointer(np.int32, flags="C"), np.ctypeslib.ndpointer(np.float64, flags="C")
    library.plc_run.argtypes = [
        ctypes.c_void_p, ctypes.c_int, rows, ctypes.c_int, where, rows, ctypes.c_int, where, rows,
    ]  # fmt: skip
    return library


class DoesNotCompileError(Exception):
    """The machine's diagnostics."""


class Machine:
    """A function block in a program of its own, run in the machine.

    Without its comments: the machine takes none between declarations. Our reader, blark and tree-sitter take them.
    """

    def __init__(self, text):
        need(LIBRARY)
        text = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
        name, self.inputs, self.outputs = interface(text)
        source = f"{text}\n{program(name, self.inputs, self.outputs)}"
        message = ctypes.create_string_buffer(4000)
        self.handle = _library().plc_load(source.encode(), message, len(message))
        if not self.handle:
            raise DoesNotCompileError(message.value.decode())

    def __del__(self):
        if getattr(self, "handle", None):
            _library().plc_free(self.handle)

    def run(self, cold, columns, rows, wanted):
        """Outputs `wanted` (n, len(wanted)) for rows (n, len(columns)) of inputs and settings; cold starts (n,)."""
        cold = np.ascontiguousarray(cold, dtype=np.float64)
        rows = np.ascontiguousarray(rows, dtype=np.float64)
        result = np.empty((len(rows), len(wanted)))
        places = [self._places("in", columns), self._places("out", wanted)]
        done = _library().plc_run(
            self.handle, len(rows), cold, len(columns), places[0], rows, len(wanted), places[1], result
        )
        assert done == len(rows), f"the machine stopped in scan {done}"
        return result

    def _places(self, prefix, names):
        found = [_library().plc_find(self.handle, f"{prefix}_{name}".encode()) for name in names]
        assert min(found) >= 0, names
        return np.array(found, dtype=np.int32)


def interface(text):
    """Name of the function block, and (name, type) of its inputs and outputs."""
    name = re.search(r"FUNCTION_BLOCK (\w+)", text)[1]
    sections = dict(re.findall(r"\b(VAR_\w+|VAR)\n(.*?)END_VAR", text, re.S))
    found = [re.findall(r"(\w+) : (\w+)", sections[word]) for word in ("VAR_INPUT", "VAR_OUTPUT")]
    return name, *found


def program(name, inputs, outputs):
    """A program that calls the block with variables of its own."""
    lines = ["PROGRAM plant", "VAR", f"    tested : {name};"]
    lines += [f"    in_{variable} : {kind};" for variable, kind in inputs]
    lines += [f"    out_{variable} : {kind};" for variable, kind in outputs]
    call = ",\n    ".join(f"{variable} := in_{variable}" for variable, _ in inputs)
    lines += ["END_VAR", f"tested({call});"]
    lines += [f"out_{variable} := tested.{variable};" for variable, _ in outputs]
    return "\n".join([*lines, "END_PROGRAM", ""])


def scan_rows(source, stretches):
    """Cold starts (n,), columns, and rows (n, inputs + settings) for all stretches."""
    specification = source.specification
    names = [variable.name.lower() for part in ("input", "parameter") for variable in specification.section(part)]
    rows = [np.hstack([stretch.inputs, np.tile(stretch.parameters, (len(stretch.inputs), 1))]) for stretch in stretches]
    cold = np.zeros(sum(len(part) for part in rows))
    starts = np.cumsum([0] + [len(part) for part in rows[:-1]])
    cold[starts] = [stretch.cold for stretch in stretches]
    return cold, names, np.concatenate(rows).astype(np.float64)


def run_in_machine(text, source, stretches):
    """Outputs of the block in the machine, in the order of the specification."""
    wanted = [variable.name.lower() for variable in source.specification.section("output")]
    return Machine(text).run(*scan_rows(source, stretches), wanted)


FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off")
# ziglang's clang has no address sanitizer to link: there the second one is idle, out of bounds is seen by the first.
SANITIZE = ("-fsanitize=undefined,address", "-fno-sanitize-recover=all", "-g")
DRIVER = """
#include <stdio.h>
#include "{name}.h"
int main(void)
{{
    {name}_parameters p = {name}_defaults;
    {name}_state s;
    {name}_inputs i;
    {name}_outputs o;
    double in[{columns}];
    while (fread(in, sizeof(double), {columns}, stdin) == {columns}) {{
        if (in[0] != 0.0) {name}_reset(&s);
        {reads}
        {name}_step(&p, &s, &i, &o);
        double out[] = {{{writes}}};
        fwrite(out, sizeof(double), sizeof out / sizeof out[0], stdout);
    }}
    return 0;
}}
"""


def run_in_c(files, source, stretches, folder, flags=()):
    """Outputs of the block compiled as C99, in the order of the specification."""
    cold, names, rows = scan_rows(source, stretches)
    rows = np.column_stack([cold, rows])
    parts = {v.name.lower(): v for v in source.specification.variables if v.section in ("input", "parameter")}
    types = {"bool": "bool", "int": "int32_t", "real": "double" if source.real == "lreal" else "float"}
    reads = "\n        ".join(
        f"{'i' if parts[name].section == 'input' else 'p'}.{name} = ({types[parts[name].kind]})in[{k}];"
        for k, name in enumerate(names, 1)
    )
    writes = ", ".join(f"o.{variable.name.lower()}" for variable in source.specification.section("output"))
    files = files | {"driver.c": DRIVER.format(name=source.name, columns=rows.shape[1], reads=reads, writes=writes)}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    command = [c_compiler(), *FLAGS, *flags, "driver.c", f"{source.name}.c", "-o", "block", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    done = subprocess.run([str(folder / "block")], input=rows.tobytes(), capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    return np.frombuffer(done.stdout).reshape(len(rows), -1)
