"""Made exports of one record, as plants write them: the same samples come out, or a refusal whose command works."""

import gzip
import io
import itertools
import shlex
import zipfile

import numpy as np
import pytest

from lostmotion.errors import InputError
from lostmotion.files import read_loop
from tests.support.command import run

N = 240
DT = 5
OP = np.round(50 + 8 * np.sin(np.arange(N) / 11), 2)
PV = np.round(1200 + 90 * np.cos(np.arange(N) / 13) + np.arange(N) % 3, 1)
SP = np.full(N, 1200.0)
START = np.datetime64("2024-10-27T01:50:00")  # the clock is set back an hour after this, in the middle of the record


def moments(form, seconds=None, start=START):
    seconds = np.arange(N) * DT if seconds is None else seconds
    return [(start + int(second)).astype(object).strftime(form) for second in seconds]


def in_autumn():
    seconds = np.arange(N) * DT
    return moments("%Y-%m-%d %H:%M:%S", np.where(seconds >= 4200 - 3600, seconds - 3600, seconds), START + 3000)


UNTOUCHED = np.arange(N)
SWAPPED = np.r_[np.arange(40), 41, 40, np.arange(42, 90), np.arange(91, 150), 90, np.arange(150, N)]
TWICE = np.sort(np.r_[UNTOUCHED, 7, 99, 100])
OVERLAP = np.r_[np.arange(140), np.arange(100, N)]
TIMES = {  # stamps of the original rows, and the rows that the file holds, in its order
    "ISO": (moments("%Y-%m-%d %H:%M:%S"), UNTOUCHED),
    "ISO with zone": (moments("%Y-%m-%dT%H:%M:%S+01:00"), UNTOUCHED),
    "day first": (moments("%d.%m.%Y %H:%M:%S"), UNTOUCHED),
    "month first, AM and PM": (moments("%m/%d/%Y %I:%M:%S %p"), UNTOUCHED),
    "month by name": (moments("%d-%b-%y %H:%M:%S"), UNTOUCHED),
    "epoch in s": ([str(1_730_000_000 + DT * k) for k in range(N)], UNTOUCHED),
    "epoch in ms": ([str(1000 * (1_730_000_000 + DT * k)) for k in range(N)], UNTOUCHED),
    "day numbers": ([f"{45592.0 + DT * k / 86400:.8f}" for k in range(N)], UNTOUCHED),
    "minute stamps": (moments("%d/%m/%Y %H:%M"), UNTOUCHED),
    "over midnight": (moments("%H:%M:%S", start=np.datetime64("2024-03-01T23:50:00")), UNTOUCHED),
    "newest first": (moments("%Y-%m-%d %H:%M:%S"), UNTOUCHED[::-1]),
    "minute stamps, newest first": (moments("%Y-%m-%d %H:%M"), UNTOUCHED[::-1]),
    "disorder": (moments("%Y-%m-%d %H:%M:%S"), SWAPPED),
    "rows twice": (moments("%Y-%m-%d %H:%M:%S"), TWICE),
    "two exports that overlap": (moments("%Y-%m-%d %H:%M:%S"), OVERLAP),
    "autumn": (in_autumn(), UNTOUCHED),
}
NAMES = {  # time, OP, PV, SP
    "plain": ("Time", "OP", "PV", "SP"),
    "DeltaV": ("Timestamp", "FIC-101/PID1/OUT.CV", "FIC-101/PID1/PV.CV", "FIC-101/PID1/SP.CV"),
    "Foxboro": ("Date Time", "U1:FIC101.OUT", "U1:FIC101.MEAS", "U1:FIC101.SPT"),
    "Yokogawa": ("Time", "FIC101.MV", "FIC101.PV", "FIC101.SV"),
    "Honeywell": ("TIMESTAMP", "FIC101.OP (%)", "FIC101.PV (m3/h)", "FIC101.SP (m3/h)"),
    "ISA": ("time", "FV_101", "FT_101", "SP"),
    "German": ("Zeitstempel", "Stellgröße [%]", "Istwert [t/h]", "Sollwert [t/h]"),
    "French": ("Horodatage", "Commande", "Mesure", "Consigne"),
    "Spanish": ("Fecha y hora", "Salida del controlador", "Medición", "Consigna"),
    "Portuguese": ("Data/Hora", "Saída do controlador", "Medição", "Referência"),
}


def text_of(times, order, names, delimiter, decimal, extra=(), thousands="", end="\n"):
    """Text of an export: `extra` names a preamble, rows of units or descriptions, or a header that stands again."""

    def number(value):
        written = f"{value:,.2f}" if thousands else f"{value:.2f}"
        swapped = written.translate(str.maketrans({",": thousands or ",", ".": decimal}))
        return f'"{swapped}"' if delimiter in swapped else swapped

    lines = [delimiter.join(names)]
    if "units" in extra:
        lines.append(delimiter.join(["", "%", "m3/h", "m3/h"]))
    if "descriptions" in extra:
        lines.insert(0, delimiter.join(["", "valve", "flow to reactor", "wanted"]))
    if "preamble" in extra:
        lines[:0] = ["Trend export", "made by plant 1", ""]
    for place, row in enumerate(order):
        stamp = times[row].replace(".", decimal) if times[row].count(".") == 1 else times[row]  # a day number
        lines.append(delimiter.join([stamp, *(number(values[row]) for values in (OP, PV, SP))]))
        if "header again" in extra and place == N // 2:
            lines.append(delimiter.join(names))
    return end.join([*lines, ""])


DRESSES = {
    "commas": {"delimiter": ",", "decimal": "."},
    "semicolons": {"delimiter": ";", "decimal": ",", "extra": ("units",)},
    "tabs": {"delimiter": "\t", "decimal": ".", "extra": ("preamble", "units"), "end": "\r\n"},
    "thousands": {"delimiter": ";", "decimal": ",", "thousands": ".", "extra": ("descriptions", "units")},
    "quoted thousands": {"delimiter": ",", "decimal": ".", "thousands": ",", "extra": ("preamble",), "end": "\r"},
    "header again": {"delimiter": ";", "decimal": ".", "extra": ("header again",)},
}
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "latin-1")


def packed(raw, how):
    if how == "gz":
        return gzip.compress(raw)
    if how == "zip":
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("export.csv", raw)
        return stream.getvalue()
    return raw


CROSSED = [
    (times, dress, names, encoding, how)
    for (times, dress), names, encoding, how in zip(
        itertools.product(TIMES, DRESSES),
        itertools.cycle(NAMES),
        itertools.cycle(ENCODINGS),
        itertools.cycle(("", "", "", "gz", "zip")),
        strict=False,
    )
]


def assert_the_original(record):
    assert record.dt == pytest.approx(DT, rel=1e-3)
    np.testing.assert_array_equal(record.op, OP)
    np.testing.assert_array_equal(record.pv, PV)
    assert record.gaps == ()


def test_corpus_is_large():
    assert len(CROSSED) >= 90
    assert {names for _, _, names, _, _ in CROSSED} == set(NAMES)


@pytest.mark.sampled(53)
@pytest.mark.parametrize(("times", "dress", "names", "encoding", "how"), CROSSED)
def test_reads_to_the_same_samples(tmp_path, times, dress, names, encoding, how):
    stamps, order = TIMES[times]
    text = text_of(stamps, order, NAMES[names], **DRESSES[dress])
    path = tmp_path / f"FIC-101.csv{'.' if how else ''}{how}"
    path.write_bytes(packed(text.encode(encoding), how))
    assert_the_original(read_loop(path))


HELD = np.repeat(OP[::3], 3)  # an OP that moves every third sample


@pytest.mark.sampled(24)
@pytest.mark.parametrize("own", [False, True], ids=["one clock", "own times"])
@pytest.mark.parametrize("dress", ["commas", "semicolons", "tabs"])
@pytest.mark.parametrize("times", TIMES)
def test_a_file_for_each_tag_reads_to_the_same_samples(tmp_path, times, dress, own):
    stamps, order = TIMES[times]
    look = DRESSES[dress]
    decimal, delimiter, end = look["decimal"], look["delimiter"], look.get("end", "\n")
    for role, values in (("OP", HELD), ("PV", PV), ("SP", SP)):
        rows = [row for row in order if not own or role == "PV" or (role == "OP" and row % 3 == 0) or row == 0]
        lines = [delimiter.join(("Timestamp", "Value", "Quality"))]
        for row in rows:
            stamp = stamps[row].replace(".", decimal) if stamps[row].count(".") == 1 else stamps[row]
            lines.append(delimiter.join((stamp, f"{values[row]:.2f}".replace(".", decimal), "Good")))
        (tmp_path / f"FIC101_{role}.csv").write_text(end.join([*lines, ""]))
    if own and times.startswith("minute stamps"):
        with pytest.raises(InputError, match="one value of a tag at a time"):
            read_loop(tmp_path)
        return
    record = read_loop(tmp_path)
    assert record.dt == pytest.approx(DT, rel=1e-3)
    np.testing.assert_array_equal(record.op, HELD)
    np.testing.assert_array_equal(record.pv, PV)
    np.testing.assert_array_equal(record.sp, SP)
    assert record.gaps == ()
    assert "files of one tag each" in record.notes[0]


def wide(names_of, tags=("FIC101", "FIC102")):
    head = ["Time", *(name for tag in tags for name in names_of(tag))]
    rows = [f"{DT * k},{OP[k]},{PV[k]},{SP[k]},{OP[-1 - k]},{PV[-1 - k]},{SP[-1 - k]}" for k in range(N)]
    return "\n".join([",".join(head), *rows, ""])


def dates_of_two_readings():
    return "\n".join(["Time,OP,PV", *(f"{1 + k // 9:02d}/{1 + k % 9:02d}/24,{OP[k]},{PV[k]}" for k in range(80)), ""])


def table(head, times, more=""):
    return "\n".join([head, *(f"{time},{op},{pv}{more}" for time, op, pv in zip(times, OP, PV, strict=False)), ""])


def long_table():
    rows = []
    for tag, values in (("FIC101.OP", OP), ("FIC101.PV", PV), ("FIC102.OP", OP[::-1]), ("FIC102.PV", PV[::-1])):
        rows += [f"{tag},{time},{value},Good" for time, value in zip(TIMES["ISO"][0], values, strict=True)]
    return "\n".join(["Tag,Timestamp,Value,Quality", *rows, ""])


RANDOM = np.random.default_rng(3)
UNEVEN = np.cumsum(RANDOM.exponential(DT, N)) + 3.7
AMBIGUOUS = {  # text, and whether the original comes out of the first command
    "two loops by dots": (wide(lambda tag: (f"{tag}.OUT", f"{tag}.PV", f"{tag}.SP")), True),
    "two loops of DeltaV": (wide(lambda tag: (f"{tag}/PID1/OUT.CV", f"{tag}/PID1/PV.CV", f"{tag}/PID1/SP.CV")), True),
    "two loops by ISA": (wide(lambda tag: (f"FV_{tag[3:]}", f"FT_{tag[3:]}", f"{tag}.SP")), True),
    "two loops in a long table": (long_table(), True),
    "two clocks": (table("Time,OP,PV,ts", np.arange(N) * DT, ",7"), True),
    "days or seconds": (table("Time,OP,PV", 45000.5 + 0.01 * np.arange(N)), False),
    "tags of two numbers": (table("Time,LV_106,FT_115", np.arange(N) * DT), True),
    "names of no system": (table("Time,valve_a,flow_a", np.arange(N) * DT), True),
    "irregular": (table("Time,OP,PV", UNEVEN), False),
    "two OP": (table("Time,CO,PV,MV", np.arange(N) * DT, ",1"), None),
    "dates of two readings": (dates_of_two_readings(), None),
    "rows of one time that differ": (table("Time,OP,PV", (np.arange(N) - (np.arange(N) == 9)) * DT), None),
    "one stamp": (table("Time,OP,PV", [7] * N), None),
    "recordings one into the other": (table("Time,OP,PV", np.r_[np.arange(120), 0.5 + np.arange(120)] * DT + 3), None),
    "decimal marks of two kinds": (table("Time;OP;PV", []) + '0;1,5;2.5\n5;1,6;2.6\n', None),
    "neither time nor dt": ("\n".join(["OP,PV", *(f"{o},{p}" for o, p in zip(OP, PV, strict=True)), ""]), None),
}  # fmt: skip


@pytest.mark.parametrize("case", AMBIGUOUS)
def test_what_is_ambiguous_is_refused_with_commands_that_work(capsys, tmp_path, case):
    text, leads = AMBIGUOUS[case]
    path = tmp_path / "FIC 101.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_loop(path)
    _, text, error = run(capsys, "check", path)
    commands = [line.strip() for line in (text + error).splitlines() if line.startswith("    lostmotion check")]
    assert bool(commands) == (leads is not None) or case == "two OP"
    for command in commands:
        assert run(capsys, *shlex.split(command)[1:])[2] == "", command
    if leads:
        assert_the_original(read_loop(path, **caught.value.ways[0]))
