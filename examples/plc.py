"""What executes an exported block here: the ST machine, else C by gcc or clang, else the kernel itself.

The first two run the written code, not the kernel. In the ST machine the PI controller and the scaling of the analogue
cards are Structured Text too; beside C and the kernel they are the same lines in Python. The PI rests while PV is
bad.
"""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import lostmotion as lm
from lostmotion.export import export

MACHINE = Path(__file__).resolve().parents[1] / ".venv-plc" / "machine.so"  # made by `make plc`
COUNTS = 276.48  # of an analogue card for 1 %: 27648 for 100 %
OUTPUTS = ("op_in", "op_out", "back", "offset", "state", "op_raw")

PI_TEXT = """
FUNCTION_BLOCK PI_LOOP
VAR_INPUT
    sp : LREAL; pv : LREAL; kp : LREAL; ki_scan : LREAL; low : LREAL; high : LREAL;
    manual : BOOL; hold : BOOL; back : LREAL;
END_VAR
VAR_OUTPUT
    op : LREAL;
END_VAR
VAR
    started : BOOL; integral : LREAL; earlier : LREAL; deviation : LREAL;
END_VAR
IF hold AND started AND (NOT manual) THEN
    RETURN;
END_IF;
deviation := sp - pv;
IF manual OR (NOT started) THEN
    integral := back - kp * deviation;
    earlier := integral;
ELSIF op > back THEN
    integral := MIN(integral, earlier);
ELSIF op < back THEN
    integral := MAX(integral, earlier);
END_IF;
IF NOT manual THEN
    earlier := integral;
    integral := integral + ki_scan * deviation;
END_IF;
op := kp * deviation + integral;
IF op > high THEN
    op := high;
    IF deviation > 0.0 THEN integral := MIN(integral, earlier); END_IF;
ELSIF op < low THEN
    op := low;
    IF deviation < 0.0 THEN integral := MAX(integral, earlier); END_IF;
END_IF;
started := TRUE;
END_FUNCTION_BLOCK
"""
PROGRAM_TEXT = """
PROGRAM plant
VAR
    sp : LREAL; pv_raw : DINT; op_raw : DINT; manual : BOOL; manual_value : LREAL; block_on : BOOL; pv_good : BOOL;
    start_value : LREAL; op_in : LREAL; op_out : LREAL; back : LREAL; offset : LREAL; state : DINT; begun : BOOL;
    controller : PI_LOOP; block : {name};
END_VAR
IF NOT begun THEN back := start_value; begun := TRUE; END_IF;
controller(sp := sp, pv := DINT_TO_LREAL(pv_raw) / {counts}, hold := NOT pv_good,
    kp := {kp}, ki_scan := {ki_scan}, low := {low},
    high := {high}, manual := manual, back := back);
op_in := controller.op;
block(op_in := op_in, enable := block_on, good := pv_good, track := manual, track_value := manual_value{settings});
op_out := block.op_out;
back := block.back;
offset := block.offset;
state := block.state;
op_raw := LREAL_TO_DINT(op_out * {counts});
END_PROGRAM
"""
SHIM = """
#include "{name}.h"
static {name}_state s;
void begin(void) {{ {name}_reset(&s); }}
void scan(const double *in, double *out)
{{
    const {name}_parameters p = {name}_defaults;
    {name}_inputs i = {{0}};
    {name}_outputs o;
    i.op_in = in[0]; i.enable = in[1] != 0.0; i.good = in[2] != 0.0; i.track = in[3] != 0.0; i.track_value = in[4];
    {name}_step(&p, &s, &i, &o);
    out[0] = o.op_out; out[1] = o.back; out[2] = o.offset; out[3] = (double)o.state;
}}
"""


class InStMachine:
    """PI, block and cards in Structured Text, compiled and executed scan by scan."""

    what = "Structured Text, compiled and executed in the ST machine, with the PI controller in ST as well"

    def __init__(self, block: lm.CompensatorBlock, controller: lm.PI, start: float) -> None:
        self.code = export(block, "st", name="FY_101", date="2026-01-31").code["FY_101.st"]
        names = [v.name.lower() for v in block.specification.section("parameter")]
        defaults = dict(re.findall(r"^    (\w+) : \w+ := ([^;]+);", self.code, flags=re.MULTILINE))
        program = PROGRAM_TEXT.format(
            name="FY_101", counts=COUNTS, kp=controller.kp, ki_scan=controller.ki * block.scan_time,
            low=controller.low, high=controller.high,
            settings="".join(f",\n    {name} := {defaults[name]}" for name in names),
        )  # fmt: skip
        text = re.sub(r"\(\*.*?\*\)", "", self.code, flags=re.DOTALL) + PI_TEXT + program
        self._library = ctypes.CDLL(str(MACHINE))
        self._library.plc_load.restype = ctypes.c_void_p
        self._library.plc_load.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_int]
        self._library.plc_find.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
        doubles, places = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)
        self._library.plc_run.argtypes = [
            ctypes.c_void_p, ctypes.c_int, doubles, ctypes.c_int, places, doubles, ctypes.c_int, places, doubles,
        ]  # fmt: skip
        message = ctypes.create_string_buffer(4000)
        self._handle = self._library.plc_load(text.encode(), message, len(message))
        if not self._handle:
            raise RuntimeError(f"expected ST that compiles, got: {message.value.decode()}")
        inputs = ("sp", "pv_raw", "manual", "manual_value", "block_on", "pv_good", "start_value")
        self._in, self._out = self._places(inputs), self._places(OUTPUTS)
        self._start = start

    def _places(self, names: tuple[str, ...]) -> ctypes.Array[ctypes.c_int]:
        found = [self._library.plc_find(self._handle, name.encode()) for name in names]
        if min(found) < 0:
            raise RuntimeError(f"expected variables {names}, got places {found}")
        return (ctypes.c_int * len(names))(*found)

    def scan(
        self, sp: float, pv_raw: int, block_on: bool, pv_good: bool, manual: bool, manual_value: float
    ) -> tuple[float, ...]:
        """One scan; what OUTPUTS names."""
        rows = (ctypes.c_double * 7)(sp, pv_raw, manual, manual_value, block_on, pv_good, self._start)
        found = (ctypes.c_double * len(OUTPUTS))()
        cold = (ctypes.c_double * 1)(0.0)
        if self._library.plc_run(self._handle, 1, cold, 7, self._in, rows, len(OUTPUTS), self._out, found) != 1:
            raise RuntimeError("the machine stopped")
        return tuple(found)


class InC:
    """The exported C99, compiled by gcc or clang; PI and cards in Python."""

    what = "C99 compiled by gcc (no ST machine here: `make plc` makes it), with the PI controller in Python"

    def __init__(self, block: lm.CompensatorBlock, controller: lm.PI, start: float) -> None:
        files = export(block, "c", name="FY_101", date="2026-01-31").code
        flags = ("-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC")
        with tempfile.TemporaryDirectory() as folder:  # a library that is loaded stays when its file goes
            for name, text in {**files, "shim.c": SHIM.format(name="FY_101")}.items():
                Path(folder, name).write_text(text, encoding="utf-8")
            subprocess.run(
                [c_compiler() or "gcc", *flags, "shim.c", "FY_101.c", "-o", "b.so", "-lm"],
                cwd=folder,
                check=True,
            )
            self._library = ctypes.CDLL(str(Path(folder, "b.so")))
        self._library.begin()
        self._pi = _PI(controller, block.scan_time, start)

    def scan(
        self, sp: float, pv_raw: int, block_on: bool, pv_good: bool, manual: bool, manual_value: float
    ) -> tuple[float, ...]:
        """One scan; what OUTPUTS names."""
        op_in = self._pi.step(sp, pv_raw / COUNTS, pv_good, manual)
        given = (ctypes.c_double * 5)(op_in, block_on, pv_good, manual, manual_value)
        found = (ctypes.c_double * 4)()
        self._library.scan(given, found)
        self._pi.back = found[1]
        return op_in, *found, float(round(found[0] * COUNTS))


class InKernel:
    """The simulated block itself; PI and cards in Python."""

    what = "the kernel itself (no ST machine and no C compiler here), with the PI controller in Python"

    def __init__(self, block: lm.CompensatorBlock, controller: lm.PI, start: float) -> None:
        self._block, self._pi = block, _PI(controller, block.scan_time, start)
        block.reset()

    def scan(
        self, sp: float, pv_raw: int, block_on: bool, pv_good: bool, manual: bool, manual_value: float
    ) -> tuple[float, ...]:
        """One scan; what OUTPUTS names."""
        op_in = self._pi.step(sp, pv_raw / COUNTS, pv_good, manual)
        op_out = self._block.step(op_in, block_on, pv_good, manual_value if manual else None)
        last = self._block.last
        self._pi.back = last["back"]
        return op_in, op_out, last["back"], last["offset"], last["state"], float(round(op_out * COUNTS))


class _PI:
    """PI_TEXT in Python."""

    def __init__(self, controller: lm.PI, scan_time: float, start: float) -> None:
        self._settings, self._ki_scan = controller, controller.ki * scan_time
        self.back, self._op, self._integral, self._started = start, 0.0, 0.0, False

    def step(self, sp: float, pv: float, good: bool, manual: bool) -> float:
        if not (good or manual) and self._started:
            return self._op
        deviation, pi = sp - pv, self._settings
        if manual or not self._started:
            self._integral = self._earlier = self.back - pi.kp * deviation
        elif self._op > self.back:
            self._integral = min(self._integral, self._earlier)
        elif self._op < self.back:
            self._integral = max(self._integral, self._earlier)
        if not manual:
            self._earlier = self._integral
            self._integral += self._ki_scan * deviation
        self._op = pi.kp * deviation + self._integral
        if self._op > pi.high:
            self._op = pi.high
            self._integral = min(self._integral, self._earlier) if deviation > 0.0 else self._integral
        elif self._op < pi.low:
            self._op = pi.low
            self._integral = max(self._integral, self._earlier) if deviation < 0.0 else self._integral
        self._started = True
        return self._op


def c_compiler() -> str | None:
    """gcc, else the clang that `make plc` fetches where there is none."""
    return shutil.which("gcc") or shutil.which("cc", path=MACHINE.parent / "bin")


def best_plc() -> type[InStMachine | InC | InKernel]:
    """What can be had here."""
    if MACHINE.exists():
        return InStMachine
    return InC if c_compiler() else InKernel
