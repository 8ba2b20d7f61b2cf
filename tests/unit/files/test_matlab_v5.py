"""MAT files of version 5, beside the reader of SciPy, and with bytes changed."""

import io
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.io import loadmat, savemat

from lostmotion.errors import DataError
from lostmotion.files import limits, read_loop
from lostmotion.files.matlab import MAT
from lostmotion.files.matlab_v5 import leaves_of_version_5
from lostmotion.files.structs import is_column

numbers = st.sampled_from(["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"]).flatmap(
    lambda kind: hnp.arrays(kind, hnp.array_shapes(max_dims=2, max_side=5, min_side=0))
)
words = st.text(st.characters(codec="ascii", min_codepoint=33), min_size=1, max_size=6)
names = st.text("abcXYZ_", min_size=1, max_size=5).map(lambda text: f"v{text}")
cells = st.lists(words, min_size=1, max_size=4).map(lambda texts: np.array(texts, dtype=object))
values = numbers | words | cells | st.booleans()
contents = st.dictionaries(
    names, st.recursive(values, lambda inside: st.dictionaries(names, inside, min_size=1, max_size=3), max_leaves=6),
    min_size=1, max_size=4,
)  # fmt: skip


def by_scipy(variables, above=""):
    """Dotted path and value of every variable that is no struct."""
    for name, value in variables.items():
        array = np.asarray(value)
        if array.dtype.names and array.ndim == 0:
            yield from by_scipy({field: array[field].item() for field in array.dtype.names}, f"{above}{name}.")
        elif array.dtype.names:
            for place, one in enumerate(array.ravel()):
                yield from by_scipy({field: one[field] for field in array.dtype.names}, f"{above}{name}({place + 1}).")
        else:
            yield f"{above}{name}", value


def assert_same(raw):
    content = loadmat(io.BytesIO(raw), squeeze_me=True)
    expected = dict(by_scipy({name: value for name, value in content.items() if not name.startswith("__")}))
    found = dict(leaves_of_version_5(raw))
    assert list(found) == list(expected)
    for path, value in expected.items():
        assert is_column(found[path]) == is_column(value)
        if is_column(value):
            stripped = [str(cell).rstrip() for cell in value] if np.asarray(value).dtype.kind in "OU" else value
            np.testing.assert_array_equal(found[path], stripped)
        elif isinstance(value, str) or (np.size(value) == 1 and np.asarray(value).dtype.kind in "fiu"):
            np.testing.assert_array_equal(found[path], value)


@settings(max_examples=60, deadline=None)
@given(contents, st.booleans(), st.sampled_from(["row", "column"]))
def test_like_scipy(content, packed, oned_as):
    raw = io.BytesIO()
    savemat(raw, content, do_compression=packed, oned_as=oned_as)
    assert_same(raw.getvalue())


FILES = sorted((Path(scipy.io.__file__).parent / "matlab" / "tests" / "data").glob("test*_[67]*.mat"))
OTHER = ("func", "sparse", "object")  # no signals: SciPy opens some of them
FILES = [path for path in FILES if path.read_bytes().startswith(MAT) and not any(word in path.name for word in OTHER)]


@pytest.mark.skipif(not FILES, reason="SciPy was installed without its tests")
def test_files_that_matlab_wrote():
    """Of many versions, on machines of either byte order."""
    for path in FILES:
        assert_same(path.read_bytes())


def vectors(packed=False):
    raw = io.BytesIO()
    savemat(raw, {"OP": np.arange(30.0), "PV": np.arange(30.0)}, do_compression=packed)
    return raw.getvalue()


def read(tmp_path, raw):
    (tmp_path / "a.mat").write_bytes(raw)
    return read_loop(tmp_path / "a.mat", dt=1.0)


def test_the_two_bytes_that_crash_another_reader():
    """Every type of element in every tag: each is read or refused."""
    raw = vectors()
    for place in range(128, len(raw) - 240, 8):
        for kind in (*range(20), 255):
            with suppress(ValueError):
                leaves_of_version_5(raw[:place] + struct.pack("<I", kind) + raw[place + 4 :])


def test_packed_bytes_without_an_end(monkeypatch, tmp_path):
    monkeypatch.setenv(limits.MOST_GIB, "0.0009765")
    bomb = zlib.compress(bytes(1 << 23))
    with pytest.raises(
        DataError, match=r"more than 0\.0009765 GiB in the MAT file; cut the export, or set LOSTMOTION_MOST_GIB"
    ):
        read(tmp_path, vectors()[:128] + struct.pack("<II", 15, len(bomb)) + bomb)


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (vectors()[:200], "it ends within a variable"),
        (vectors()[:126] + b"XY" + vectors()[128:], "no byte order in its header"),
        (vectors(packed=True)[:-9], "it ends within a variable"),
        (vectors()[:128] + struct.pack("<II", 15, 4) + b"abcd", "incorrect header check"),
    ],
)
def test_damaged(tmp_path, raw, said):
    with pytest.raises(DataError, match=said):
        read(tmp_path, raw)


def test_structs_without_end(tmp_path):
    """A struct in a struct in a struct: a cell of a cell of a cell needs 56 bytes each."""
    inside = b""
    for _ in range(500):
        body = struct.pack("<IIII", 6, 8, 1, 0) + struct.pack("<IIii", 5, 8, 1, 1) + struct.pack("<II", 1, 0) + inside
        inside = struct.pack("<II", 14, len(body)) + body
    with pytest.raises(DataError, match="structs deeper than 40"):
        read(tmp_path, vectors()[:128] + inside)


def test_more_rows_of_no_text_than_can_be_counted(tmp_path):
    body = struct.pack("<IIII", 6, 8, 4, 0) + struct.pack("<IIii", 5, 8, 2**31 - 1, 0) + struct.pack("<II", 1, 0)
    with pytest.raises(DataError, match="vectors of one length"):
        read(tmp_path, vectors()[:128] + struct.pack("<II", 14, len(body)) + body)
