"""What a followed record gives does not depend on how its bytes arrive."""

import json
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.files.follow import Follower
from lostmotion.files.layout import Asked

ROWS = 90
odd_cells = st.sampled_from(["", "Bad", "?!", "1.000.000", "1e40", '"2"', '"', "#N/A", "1,5,6,7"])
odd_lines = st.sampled_from(["", "# note", "time;Mode;OP;PV", ";;;"])
odd_late_lines = st.sampled_from(["\x00\x00", "ü", "1;2"])
steps = st.sampled_from([1.0] * 12 + [0.0, 0.1, 1.4, -5.0, 3.0, 1500.0, -9000.0])


class Dribble:
    """Stream whose bytes come in given pieces."""

    def __init__(self, raw, cuts):
        places = [0, *sorted(min(cut, len(raw)) for cut in cuts), len(raw)]
        self.pieces = [raw[start:stop] for start, stop in pairwise(places)]

    def fileno(self):
        raise OSError

    def read(self, size):
        assert all(len(piece) <= size for piece in self.pieces)
        return self.pieces.pop(0) if self.pieces else b""


@st.composite
def records(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    decimal = draw(st.sampled_from([".", ","]))
    plain = draw(st.booleans())  # numbers without a mark in the first rows
    times = 100.0 + np.cumsum([1.0] * 65 + draw(st.lists(steps, min_size=ROWS - 65, max_size=ROWS - 65)))
    lines = ["time;Mode;OP;PV"]
    for k, time in enumerate(times):
        cells = [f"{time:.6g}" if plain and k < 70 else f"{time:.4f}", ["AUTO", "MAN"][rng.integers(2)]]
        cells += [str(rng.integers(9)) if plain and k < 70 else repr(float(rng.normal())) for _ in range(2)]
        lines.append(";".join(cell.replace(".", decimal) for cell in cells))
    for _ in range(draw(st.integers(0, 6))):
        place = draw(st.integers(63, len(lines) - 1))
        fields = lines[place].split(";")
        fields[draw(st.sampled_from([0, 1, 2, -1]))] = draw(odd_cells)
        lines[place] = ";".join(fields)
    for _ in range(draw(st.integers(0, 3))):
        lines.insert(draw(st.integers(1, len(lines))), draw(odd_lines))
    for _ in range(draw(st.integers(0, 1))):
        lines.insert(draw(st.integers(66, len(lines))), draw(odd_late_lines))
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    return (end.join(lines) + end).encode(draw(st.sampled_from(["utf-8", "utf-8-sig", "latin-1"])))


def follow(raw, cuts, most, stop=None):
    """All samples, notes and the final position; with `stop`, from a kept position after so many pieces."""
    asked = Asked(mode="Mode")
    stream = Dribble(raw, cuts)
    follower = Follower(stream, asked)
    parts = []
    for number in range(len(stream.pieces)):
        parts.append(follower.read(most))
        while follower.more:
            parts.append(follower.read(most))
        if number == stop and follower.layout is not None:
            follower = taken_up(follower, raw, stream, asked)
    parts.append(follower.finish())
    while follower.more:
        parts.append(follower.read())
    columns = [np.concatenate([getattr(part, name) for part in parts]) for name in ("time", "op", "pv")]
    automatic = np.concatenate([part.automatic for part in parts if len(part)])
    offsets = np.cumsum([0, *(len(part) for part in parts)])
    breaks = np.concatenate([part.breaks + at for part, at in zip(parts, offsets, strict=False)])
    notes = [note for part in parts for note in part.notes]
    return [*columns, automatic, breaks], notes, follower.position | {"end": ""}


def taken_up(follower, raw, stream, asked):
    """Another follower from the kept position; the stream goes on at the first line that was not taken."""
    position = json.loads(json.dumps(follower.position, allow_nan=False))
    stream.pieces[:0] = [follower._lines.waiting]
    return Follower(stream, asked, position)


@pytest.mark.long
@settings(max_examples=50)
@given(records(), st.lists(st.integers(0, 4000), max_size=30), st.integers(1, 100))
def test_cuts_between_any_bytes_change_nothing(raw, cuts, most):
    (whole, notes, position), (cut, same_notes, same_position) = follow(raw, [], 20_000), follow(raw, cuts, most)
    for expected, found in zip(whole, cut, strict=True):
        np.testing.assert_array_equal(found, expected)
    assert repr(same_notes) == repr(notes)
    assert same_position == position


@settings(max_examples=50)
@given(records(), st.lists(st.integers(0, 4000), min_size=1, max_size=8), st.integers(0, 8))
def test_stopping_and_going_on_changes_nothing(raw, cuts, stop):
    (whole, notes, position), (cut, same_notes, _) = follow(raw, [], 20_000), follow(raw, cuts, 20_000, stop)
    if position["grid"]["counts"]["restarts"]:
        return  # a stream that may begin again cannot tell a new recording from rows it has seen
    for expected, found in zip(whole, cut, strict=True):
        np.testing.assert_array_equal(found, expected)
    assert repr(same_notes) == repr(notes)
