"""Text and other single files that the readers refuse, with the settings they are read with."""

import gzip
import io
import zipfile

import numpy as np

from lostmotion.files import matlab

N = 60
OP = np.round(50 + 8 * np.sin(np.arange(N) / 4), 2)
PV = np.round(20 + 3 * np.cos(np.arange(N) / 5) + np.arange(N) % 3, 2)


def rows(times=None, head="time,OP,PV", more=""):
    times = range(N) if times is None else times
    return "\n".join([head, *(f"{t},{o},{p}{more}" for t, o, p in zip(times, OP, PV, strict=False)), ""])


def changed(row, cells):
    lines = rows().split("\n")
    lines[row] = cells
    return "\n".join(lines)


WIDE = rows(head="time,FIC1.OP,FIC1.PV,FIC2.OP,FIC2.PV", more=",1,2")
LONG = "\n".join(
    ["Tag,Time,Value", *(f"F1.{tag},{k},{k % 7}" for k in range(N) for tag in ("OP", "PV", "PV")[: 2 + (k == 9)])]
)
LONG = LONG.replace("F1.PV,9,2\nF1.PV,9,2", "F1.PV,9,2\nF1.PV,9,3")
TIMES_AS_TAG = "\n".join(["Tag,Time,Value", *(f"{tag},{k},{k % 7}" for k in range(N) for tag in ("OP", "PV", "Time"))])
DATES = [f"{1 + k // 9:02d}/{1 + k % 9:02d}/24" for k in range(N)]

TEXTS = {  # text of a file, and the settings it is read with
    "empty": (" \n", {}),
    "binary": (b"\0\1\2", {}),
    "blank lines and comments only": ("# a\n\n", {}),
    "header only": ("time,OP,PV\n", {}),
    "no header": (rows().split("\n", 1)[1], {}),
    "no columns": ("speed\nhigh\nlow\n", {}),
    "one column with a blank line": ("FIC1.OP\n1\n\n2\n", {}),
    "a letter": ("Dear colleague,\n\nplease find below our remarks.\n\nKind regards\n", {}),
    "a row too long": (changed(9, "8,1,2,3"), {}),
    "a quote that is not closed": ('time,OP,PV\n0,1,2\n1,"2,3\n2,3,4\n', {}),
    "one row": ("time,OP,PV\n0,1,2\n", {}),
    "a word for a number": (changed(9, "8,open,2"), {}),
    "too large a number": (changed(9, "8,1e35,2"), {}),
    "two decimal marks": (rows().replace(",", ";").replace("50.0", "50,0"), {}),
    "a thousand or a decimal": ("\n".join(["OP,PV", *(f'"{k % 9 + 1},12{k % 7}",3' for k in range(N))]), {}),
    "no OP": (rows(head="time,valve,PV"), {}),
    "two of one role": (rows(head="time,CO,PV,MV", more=",1"), {}),
    "two that differ in case": (rows(head="time,Out1,OUT1,PV", more=",1"), {"op": "out1"}),
    "a name that is not there": (rows(), {"op": "FV1"}),
    "several actuators": ("target pos (1),pos (1),target pos (2),pos (2)\n1,1,2,2\n2,2,3,3\n", {"dt": 1.0}),
    "one column for two roles": (rows(head="time,valve,PV"), {"op": "valve", "pv": "valve"}),
    "several loops": (WIDE, {}),
    "a loop that is not there": (WIDE, {"loop": "FIC9"}),
    "two values of one tag": (LONG, {}),
    "a tag called as the times": (TIMES_AS_TAG, {}),
    "no times": (rows(head="n,OP,PV"), {"time": False}),
    "a time is missing": (changed(9, ",1,2"), {}),
    "a word for a time": (rows([f"2024-03-01 10:00:{k:02d}" for k in range(N)]).replace("10:00:09", "later"), {}),
    "times of words": (rows(["noon"] * N), {}),
    "no time at all": (rows([""] * N), {}),
    "dates of two readings": (rows(DATES), {}),
    "days or seconds": (rows([45000.5 + 0.01 * k for k in range(N)]), {}),
    "rows of one time that differ": (rows(np.arange(N) - (np.arange(N) == 9)), {}),
    "one stamp": (rows([7] * N), {}),
    "two recordings one into the other": (rows(np.r_[np.arange(N // 2), 0.5 + np.arange(N // 2)] + 3), {}),
    "times of no rate": (rows(np.cumsum(np.random.default_rng(3).exponential(5.0, N)) + 3.7), {}),
    "two clocks": (rows(head="time,OP,PV,ts", times=10 * np.arange(N), more=",7"), {}),
    "another dt": (rows(times=10 * np.arange(N)), {"dt": 7.0}),
    "dt below zero": (rows(), {"dt": -1.0}),
    "missing values that are not wanted": (changed(9, "8,,2"), {"missing": "error"}),
    "another word for missing": (rows(), {"missing": "no"}),
    "a span turned round": (rows(), {"op_span": (100.0, 0.0)}),
    "packed and damaged": (gzip.compress(rows().encode())[:-9], {}),
}  # fmt: skip


def archive(files):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as whole:
        for name, content in files.items():
            whole.writestr(name, content)
    return stream.getvalue()


def mat(**variables):
    from scipy.io import savemat

    stream = io.BytesIO()
    savemat(stream, variables)
    return stream.getvalue()


TEXTS |= {
    "packed records": (archive({"a.csv": rows(), "x/b.csv": rows(), "x/readme.txt": ""}), {}),
    "packed and no data": (archive({"a.pdf": "", "b.doc": ""}), {}),
    "packed tags and records": (archive({"FIC1_OP.csv": "t_s,Value\n0,1\n1,2\n", "FIC2.csv": rows()}), {}),
    "packed and wide": (archive({"a.csv": WIDE, "b.csv": rows()}), {}),
    "packed files, damaged": (archive({"a.csv": rows(), "b.csv": rows()}).replace(b"20.", b"21.", 1), {}),
    "MAT 7.3": (matlab.MAT_HDF5 + bytes(200), {}),
    "MAT damaged": (mat(OP=OP)[:150], {}),
    "MAT without vectors": (mat(a=1.0), {}),
    "MAT of two loops": (mat(a={"OP": OP, "PV": PV}, b={"OP": OP, "PV": PV}), {"dt": 1}),
    "Parquet damaged": (b"PAR1" + bytes(40), {}),
}


def stored(folder, case):
    content, settings = TEXTS[case]
    path = folder / "FIC 101.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path, settings
