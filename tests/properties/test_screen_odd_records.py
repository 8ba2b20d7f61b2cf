"""The screen says something of any record, and raises of none."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.audit.groups.swinging import POWER
from lostmotion.audit.screen.lines import bands_in
from lostmotion.audit.screen.screen import screen
from lostmotion.audit.settings import AuditSettings
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import UNDATED, Stage

MODES = ("AUTO", "MAN", "", "9", "TRK")


@st.composite
def signals(draw, rows):
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    kind = draw(st.sampled_from(["noise", "walk", "wave", "constant", "nan", "steps", "saw", "huge", "tiny"]))
    t = np.arange(rows)
    values = {
        "noise": random.normal(size=rows),
        "walk": np.cumsum(random.normal(size=rows)),
        "wave": np.sin(t / draw(st.floats(0.5, 200.0))),
        "constant": np.full(rows, draw(st.sampled_from([0.0, 50.0, -1e29, 1e-300]))),
        "nan": np.full(rows, np.nan),
        "steps": np.round(np.cumsum(random.normal(size=rows)) / 3.0),
        "saw": (t / 30.0) % 1.0,
        "huge": random.normal(size=rows) * 1e28,
        "tiny": random.normal(size=rows) * 1e-300,
    }[kind]
    holes = draw(st.sampled_from([0.0, 0.0, 0.01, 0.4, 0.99]))
    return np.where(random.random(rows) < holes, np.nan, values)


@st.composite
def records(draw):
    rows = draw(st.sampled_from([2, 3, 31, 64, 65, 250, 1200]))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    gaps = tuple(sorted({int(row) for row in random.integers(1, rows, size=draw(st.integers(0, 3)))}))
    mode = random.choice(MODES, size=rows) if draw(st.booleans()) else None
    return LoopRecord(
        draw(signals(rows)),
        draw(signals(rows)),
        draw(signals(rows)) if draw(st.booleans()) else None,
        dt=draw(st.sampled_from([1e-3, 1.0, 60.0, 1e9])),
        mode=mode,
        gaps=gaps,
        gap_seconds=tuple(60.0 for _ in gaps) if draw(st.booleans()) else (),
    )


@settings(max_examples=50, deadline=None)
@given(records(), st.sampled_from([None, (0.0, 100.0), (5.0, 5.0), (0.0, math.nan), (-1e300, 1e300)]))
def test_screen_never_fails(record, span):
    loop = PlantLoop("X", op_span=span, pv_span=span, loop_type="a word")
    row, spectrum = screen(loop, record, UNDATED, UNDATED, AuditSettings())
    assert row.stage is Stage.SCREENED, row.error
    assert row.reason
    assert 0.0 <= row.value <= 1.0
    numbers = [row.manual, row.limited, row.missing, row.travel, row.reversals, row.variability, row.harris]
    numbers += [row.period, row.regularity, row.power, *row.indices.values()]
    assert all(value is None or math.isfinite(value) for value in numbers)
    if spectrum is not None:  # behind the powers are the lines
        power = np.frombuffer(spectrum.power[:POWER], "<f4")
        assert power.size == 96
        assert abs(float(power.sum()) - 1.0) < 1e-3
        for lines in bands_in(spectrum.power[POWER:]).values():
            assert np.isfinite(lines.values).all()
            assert abs(float(np.abs(lines.values).max()) - 1.0) < 1e-9
