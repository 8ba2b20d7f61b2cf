"""Files of every format that is read, small, and what is changed in them: bytes, lengths, numbers, order, members."""

import gzip
import io
import struct
import zipfile
import zlib
from contextlib import suppress
from functools import cache

import numpy as np
import pandas as pd
import polars as pl
from scipy.io import savemat

from tests.support.packed_files import workbook, zipped

N = 24
TIMES = [f"2024-03-01 10:00:{k:02d}" for k in range(N)]
OP, PV = np.round(50 + 8 * np.sin(np.arange(N) / 4), 2), np.round(20 + 3 * np.cos(np.arange(N) / 5), 2)
MODES = ["AUTO"] * (N - 4) + ["MAN"] * 4
ODD = (
    b"\0", b"\n", b"\r", b'"', b",", b";", b"\t", b"#", b"\xff\xfe", b"\xef\xbb\xbf", b"1e400", b"-1e308", b"1e-400",
    b"NaN", b"inf", b"-", b"9" * 400, b"9" * 20, b"0x7f", b"31/12/2024 25:61", b"9999-12-31", b"0001-01-01",
    b"24:00:00", b"2024-02-30", b"\xe2\x80\xa8", b"\xff", b"\xc3", b"PM", b"+14:00", b"Z", b"1,5", b"1.000.000", b"OP",
    b"PV", b"\n\n", b"a" * 3000, b"-0", b"1_0", b"\xd9\xa1", b"10:00:00.1234567890123", b"1e18", b"Bad", b"time",
    b"1700000000000000000",
)  # fmt: skip
SIZES = (0, 1, 2, 7, 8, 255, 256, 2**15, 2**16 - 1, 2**24, 2**31 - 1, 2**31, 2**32 - 1)


def text(head, cells, separator=",", end="\n"):
    return end.join([head, *(separator.join(map(str, row)) for row in cells), ""]).encode()


def tables_as_text():
    """Ways in which exports are written."""
    seconds = [k / 2 for k in range(N)]
    return [
        text("time,OP,PV,SP", zip(TIMES, OP, PV, [20] * N, strict=True)),
        text("t_s,OP,PV,Mode", zip(seconds, OP, PV, MODES, strict=True)),
        text("Datum;Zeit;OP;PV", ([t[8:10] + ".03.2024", t[11:], str(o).replace(".", ","), str(p).replace(".", ",")]
             for t, o, p in zip(TIMES, OP, PV, strict=True)), ";", "\r\n"),
        text("# export\nTag;FIC101\n\ntime,FIC101.OP,FIC101.PV,FIC101.Quality",
             zip(TIMES, OP, PV, ["Good"] * N, strict=True)),
        text("time\tOP\tPV\n\t%\tbar", zip(TIMES, OP, PV, strict=True), "\t").decode().encode("utf-16"),
    ]  # fmt: skip


def listed():
    """One row a value."""
    rows = [(tag, time, value) for time, o, p in zip(TIMES, OP, PV, strict=True)
            for tag, value in (("F1.OP", o), ("F1.PV", p))]  # fmt: skip
    return [text("Tag,Time,Value", rows), text("Tag\tTime\tValue\tStatus", [(*row, "Good") for row in rows], "\t")]


def frame():
    return pl.DataFrame({"time": TIMES, "OP": OP, "PV": PV, "Mode": MODES}).with_columns(
        pl.col("time").str.to_datetime()
    )


def written(write, **settings):
    raw = io.BytesIO()
    write(raw, **settings)
    return raw.getvalue()


def mat_5():
    loop = {"OP": OP, "PV": PV, "Ts": 1.0, "name": "FIC101"}
    contents = [{"OP": OP, "PV": PV, "t": np.arange(N)}, {"loop": loop}, {"a": loop, "b": {**loop, "name": "FIC102"}},
                {"OP": OP, "PV": PV, "mode": np.array(MODES, dtype=object), "K": np.eye(3)}]  # fmt: skip
    return [written(savemat_to, content=one, do_compression=packed) for one in contents for packed in (False, True)]


def savemat_to(raw, content, **settings):
    savemat(raw, content, **settings)


def mat_73():
    """As MATLAB writes it: HDF5 behind 512 bytes."""
    import h5py

    found = []
    for struct_ in (False, True):
        raw = io.BytesIO()
        with h5py.File(raw, "w", userblock_size=512) as file:
            group = file.create_group("loop") if struct_ else file
            for name, values in {"OP": OP, "PV": PV, "t": np.arange(float(N))}.items():
                group.create_dataset(name, data=values[None], compression="gzip" if struct_ else None)
            text_ = group.create_dataset("name", data=np.array([[ord(c)] for c in "FIC101"], dtype="u2"))
            text_.attrs["MATLAB_class"] = np.bytes_("char")
            cells = group.create_dataset("tags", (2, 1), h5py.ref_dtype)
            cells.attrs["MATLAB_class"] = np.bytes_("cell")
            for k in range(2):
                cells[k, 0] = text_.ref
        found.append(b"MATLAB 7.3 MAT-file".ljust(512) + raw.getvalue()[512:])
    return found


def sheets():
    cells = [[time, float(o), float(p)] for time, o, p in zip(TIMES, OP, PV, strict=True)]
    rows = [["Trend"], ["time", "OP", "PV"], ["", "%", "bar"], *cells]
    return [workbook(rows), workbook(rows, [["a"]])]


def xls():
    """A workbook of Excel 97: BIFF8 records in a container of one stream."""

    def record(kind, data=b""):
        return struct.pack("<HH", kind, len(data)) + data

    rows = [("time", "OP", "PV"), *((float(k), float(OP[k]), float(PV[k])) for k in range(N))]
    cells = b"".join(
        record(0x203, struct.pack("<HHHd", r, c, 0, cell)) if isinstance(cell, float)
        else record(0x204, struct.pack("<HHHHB", r, c, 0, len(cell), 0) + cell.encode())
        for r, row in enumerate(rows) for c, cell in enumerate(row))  # fmt: skip
    begin = record(0x809, struct.pack("<HHHHII", 0x600, 5, 0, 0, 0, 0))
    size = record(0x200, struct.pack("<IIHHH", 0, len(rows), 0, 3, 0))
    sheet = record(0x809, struct.pack("<HHHHII", 0x600, 16, 0, 0, 0, 0)) + size + cells + record(0x0A)
    listed_ = record(0x85, struct.pack("<IBBBB", len(begin) + 13 + 4, 0, 0, 1, 0) + b"S")
    return [contained(begin + listed_ + record(0x0A) + sheet)]


def contained(stream):
    """Compound file with one stream, Workbook."""
    stream = stream.ljust(max(4096, -(-len(stream) // 512) * 512), b"\0")
    sectors = len(stream) // 512
    fat = [*range(1, sectors), 0xFFFFFFFE, 0xFFFFFFFE, 0xFFFFFFFD]  # stream, directory, the table itself
    numbers = (0x3E, 3, 0xFFFE, 9, 6, 0, 1, sectors, 0, 4096, 0xFFFFFFFE, 0, 0xFFFFFFFE, 0)
    head = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(16) + struct.pack("<HHHHH6xIIIIIIIII", *numbers)
    head += struct.pack("<I", sectors + 1).ljust(436, b"\xff")

    def entry(name, kind, child, start, size):
        coded = (name + "\0").encode("utf-16-le")
        return coded.ljust(64, b"\0") + struct.pack(
            "<HBBIIi36xIQ", len(coded), kind, 1, 0xFFFFFFFF, 0xFFFFFFFF, child, start, size
        )

    folder = entry("Root Entry", 5, 1, 0xFFFFFFFE, 0) + entry("Workbook", 2, -1, 0, len(stream))
    table = struct.pack(f"<{len(fat)}I", *fat).ljust(512, b"\xff")
    return head + stream + folder.ljust(512, b"\0") + table


def parquets():
    return [written(frame().write_parquet, compression=one) for one in ("uncompressed", "zstd", "snappy")] + [
        written(frame().write_parquet, row_group_size=8)
    ]


def feathers():
    return [written(frame().write_ipc, compression=one) for one in ("uncompressed", "lz4")]


@cache
def bases(kind):
    """Files of a format, all of which are read."""
    texts = tables_as_text()
    made = {
        "csv": lambda: texts, "long": listed, "csv.gz": lambda: [gzip.compress(one) for one in texts],
        "zip": lambda: [zipped({"a.csv": one}) for one in texts[:2]], "xlsx": sheets, "xls": xls, "parquet": parquets,
        "feather": feathers, "mat 5": mat_5, "mat 7.3": mat_73,
    }  # fmt: skip
    return made[kind]()


FORMATS = ("csv", "long", "csv.gz", "zip", "xlsx", "xls", "parquet", "feather", "mat 5", "mat 7.3")
APART = ("xlsx", "xls", "mat 7.3", "parquet", "feather")  # with a reader in a process of its own
FRAMES = "frames"


def mutant(kind, number, seed=0):
    """File number `number`, always the same."""
    random = np.random.default_rng([seed, number, *kind.encode()])
    base = bases(kind)[random.integers(len(bases(kind)))]
    if random.random() < 0.5:
        inside = _inside(kind, base, random)
        if inside is not None:
            return inside
    return changed(base, random)


def _inside(kind, base, random):
    """Changed within what is packed, and packed again; None where nothing is."""
    if kind == "csv.gz":
        return gzip.compress(changed(gzip.decompress(base), random))
    if kind in ("zip", "xlsx"):
        with zipfile.ZipFile(io.BytesIO(base)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
        name = list(members)[random.integers(len(members))]
        return zipped(members | {name: changed(members[name], random)})
    if kind == "mat 5" and base[128] == 15:
        (size,) = struct.unpack_from("<I", base, 132)
        packed = zlib.compress(changed(zlib.decompress(base[136 : 136 + size]), random))
        return base[:128] + struct.pack("<II", 15, len(packed)) + packed + base[136 + size :]
    return None


def changed(raw, random):
    """A few changes, one after the other."""
    for _ in range(random.choice([1, 1, 1, 2, 4])):
        raw = CHANGES[random.integers(len(CHANGES))](raw, random) or raw
    return raw


def _place(raw, random):
    """Anywhere, or among the first bytes or the last, where headers and footers are."""
    near = min(len(raw), int(random.choice([len(raw), len(raw), 256, 64]))) or 1
    place = int(random.integers(near))
    return place if random.random() < 0.6 else max(len(raw) - 1 - place, 0)


def _byte(raw, random):
    made = bytearray(raw)
    for _ in range(random.choice([1, 1, 2, 8])):
        if made:
            made[_place(raw, random)] = random.integers(256)
    return bytes(made)


def _bit(raw, random):
    made = bytearray(raw)
    if made:
        made[_place(raw, random)] ^= 1 << random.integers(8)
    return bytes(made)


def _cut(raw, random):
    place = _place(raw, random)
    return raw[:place] if random.random() < 0.7 else raw[place:]


def _spliced(raw, random):
    first, second = sorted((_place(raw, random), _place(raw, random)))
    piece = raw[first:second][:5000]
    place = _place(raw, random)
    return raw[:place] + piece + raw[place + (len(piece) if random.random() < 0.5 else 0) :]


def _number(raw, random):
    """A length or a count in a header that says something else."""
    place, width = _place(raw, random), int(random.choice([2, 4, 8]))
    size = SIZES[random.integers(len(SIZES))] % 2 ** (8 * width)
    return raw[:place] + size.to_bytes(width, "little" if random.random() < 0.8 else "big") + raw[place + width :]


def _odd(raw, random):
    place, odd = _place(raw, random), ODD[random.integers(len(ODD))]
    return raw[:place] + odd + raw[place + (len(odd) if random.random() < 0.4 else 0) :]


def _cell(raw, random):
    """Another cell of a text, or a line of it."""
    separator = [b",", b"\n", b";", b"\t"][random.integers(4)]
    cells = raw.split(separator)
    cells[random.integers(len(cells))] = ODD[random.integers(len(ODD))]
    return separator.join(cells)


CHANGES = (_byte, _bit, _cut, _spliced, _number, _odd, _cell)


CASTS = (
    pl.Decimal(20, 3), pl.Categorical, pl.Int8, pl.Boolean, pl.Float32, pl.Binary, pl.String, pl.Date, pl.Time,
    pl.Duration,
)  # fmt: skip


def odd_frame(number, seed=0):
    """A frame of pandas or Polars with odd types, names and values."""
    random = np.random.default_rng([seed, number, 9])
    names = ["time", "OP", "PV", "SP"][: random.integers(2, 5)]
    usual = {"time": np.arange(N) / 2, "OP": OP, "PV": PV, "SP": PV}
    columns = {name: usual[name] if random.random() < 0.6 else _odd_column(random) for name in names}
    if random.random() < 0.2:
        columns[["", "OP ", "x\ny", "OP.Quality", "Mode", "ä"][random.integers(6)]] = _odd_column(random)
    if random.random() < 0.5:
        made = pl.DataFrame({name: pl.Series(name, values, strict=False) for name, values in columns.items()})
        kind = CASTS[random.integers(len(CASTS))]
        with suppress(pl.exceptions.PolarsError):  # there is no such cast
            return made.cast({random.choice(names): kind}, strict=False) if random.random() < 0.3 else made
        return made
    made = pd.DataFrame({name: pd.Series(list(values)) for name, values in columns.items()})
    kind = random.integers(6)
    if kind == 0:
        made.index = pd.date_range("2024-01-01", periods=len(made), freq="s", tz=random.choice(np.array([None, "UTC"])))
    elif kind == 1:
        made.columns = range(made.shape[1])
    elif kind == 2:
        made = pd.concat([made, made], axis=1)
    return made


def _odd_column(random):
    dates = np.datetime64("2024-03-01", "ms") + np.arange(N) * np.timedelta64(1000, "ms")
    kinds = (
        lambda: OP, lambda: PV, lambda: np.arange(N), lambda: np.arange(N) / 2, lambda: dates, lambda: dates - dates[0],
        lambda: [None] * N, lambda: [True, False] * (N // 2), lambda: np.full(N, np.nan), lambda: MODES,
        lambda: [str(x) for x in OP], lambda: [None, *OP[1:].tolist()], lambda: np.where(OP > 50, np.inf, OP),
        lambda: OP * 1e300, lambda: OP * 1e-310, lambda: OP.astype("f4"), lambda: (OP * 1e16).astype("i8"),
        lambda: np.arange(N, dtype="u8") + np.uint64(2**63), lambda: [b"\xff"] * N, lambda: [[1.0, 2.0]] * N,
        lambda: [{"a": 1}] * N, lambda: [""] * N, lambda: ["1,5"] * N, lambda: TIMES, lambda: OP.astype("i1"),
        lambda: dates[::-1] + np.timedelta64(0, "ms"), lambda: np.repeat(dates[:1], N),
        lambda: np.full(N, np.datetime64("NaT", "ns")),
    )  # fmt: skip
    return kinds[random.integers(len(kinds))]()
