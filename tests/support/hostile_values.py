"""Files of ours with one value changed, at every path, and what is done with them."""

import copy
import hashlib
import io
import json
import struct

import numpy as np

HOSTILE = (
    None, True, False, 0, 1, -1, 2**31, -(2**31), 2**63 - 1, 2**63, 10**30, 10**300, 0.5, -0.0, 1e-320, 1e308, -1e308,
    1e999, float("nan"), "", "x", "x" * 2000, "\ud800", "NaN", "../../etc", [], {}, [[]], [1.0], [1.0] * 5, {"a": 1},
    [None] * 4, ["a", "b"], [[1.0, 2.0], [3.0]], [0.0, 0.0, 0.0],
)  # fmt: skip


def paths(value, prefix=()):
    """Every place of a JSON value."""
    yield prefix
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inner:
        if not isinstance(value, list) or key < 3:
            yield from paths(one, (*prefix, key))


def changed(value, path, hostile):
    """The value with another one at the path."""
    if not path:
        return hostile
    made = copy.deepcopy(value)
    inner = made
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = hostile
    return made


def without(value, path):
    made = copy.deepcopy(value)
    inner = made
    for key in path[:-1]:
        inner = inner[key]
    del inner[path[-1]]
    return made


def mutants(value, random, share=1.0):
    """Changed, missing, superfluous, too long, too deep."""
    for path in paths(value):
        for hostile in HOSTILE:
            if random.random() < share:
                yield changed(value, path, hostile)
        if path and random.random() < share:
            yield without(value, path)


def at(value, path):
    for key in path:
        value = value[key]
    return value


def signed(kind, header, blob):
    """Bytes of :mod:`lostmotion.online.packing` with a hash that is right."""
    text = header if isinstance(header, bytes) else json.dumps(header).encode("utf-8", "surrogatepass")
    body = kind.encode() + b"\n" + struct.pack("<Q", len(text)) + text + blob
    return body + hashlib.sha256(body).digest()


def unsigned(kind, data):
    start = len(kind) + 1
    (length,) = struct.unpack_from("<Q", data, start)
    return json.loads(data[start + 8 : start + 8 + length]), data[start + 8 + length : -32]


def archived(parts):
    buffer = io.BytesIO()
    np.savez(buffer, **parts)
    return buffer.getvalue()


def unarchived(data):
    with np.load(io.BytesIO(data)) as stored:
        return {name: stored[name] for name in stored.files}


def array_mutant(array, random):
    """One array with other values, type, shape or length."""
    kind = random.integers(9)
    if not array.size or kind == 0:
        return np.zeros(int(random.integers(70)))
    if kind == 1:
        return array[: int(random.integers(array.size + 1))] if array.ndim == 1 else array[:1]
    if kind == 2:
        return array.astype([np.float32, np.int32, np.complex128, "U8", bool][random.integers(5)])
    if kind == 3:
        return array.reshape(1, *array.shape)
    if kind == 4:
        return np.concatenate([array.ravel(), array.ravel()])
    made = array.copy()
    places = random.integers(made.size, size=int(random.choice([1, 1, 1, 5, 50])))
    values = [0, 1, -1, 2**31, -(2**31), 2**62, -(2**63), 7, 100] if made.dtype.kind in "iu" else [
        np.nan, np.inf, -np.inf, 0.0, -1.0, 1e308, -1e308, 1e100, 1e20, -1e20, 1e-300, 3.0]  # fmt: skip
    for place in places:
        new = values[random.integers(len(values))]
        made.ravel()[place] = new if made.dtype.kind == "f" else np.array(new).astype(made.dtype)
    return made
