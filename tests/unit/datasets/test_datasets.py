"""The sample loops: small, made again by their script, and diagnosed rightly."""

import gzip
import json

import numpy as np
import pytest

import lostmotion as lm
import sample_loops
from lostmotion.errors import ParameterError

LARGEST = 200_000  # bytes of all files together


def test_names_and_errors():
    assert lm.datasets.names() == tuple(sorted(loop.tag for loop in sample_loops.LOOPS))
    assert len({lm.datasets.truth(name)["verdict"] for name in lm.datasets.names()}) == 6
    for call in (lm.datasets.load, lm.datasets.path, lm.datasets.truth):
        with pytest.raises(ParameterError, match=r"expected one of FIC-101, .*, got 'FIC-999'"):
            call("FIC-999")


def test_size():
    folder = lm.datasets.path("FIC-101").parent
    assert sum(one.stat().st_size for one in folder.iterdir() if one.is_file()) < LARGEST


@pytest.mark.parametrize("loop", sample_loops.LOOPS, ids=lambda loop: loop.tag)
def test_the_script_makes_them_again(loop):
    written = gzip.decompress(lm.datasets.path(loop.tag).read_bytes()).decode()
    again = sample_loops.text(loop)
    assert written.splitlines()[0] == again.splitlines()[0]
    record, columns = lm.datasets.load(loop.tag), sample_loops.simulated(loop)
    for role in ("sp", "pv", "op"):  # the last digit may depend on the processor
        found = getattr(record, role)
        np.testing.assert_allclose(found, columns[f"{loop.tag}.{role.upper()}"], rtol=0, atol=0.011)
    assert json.loads(json.dumps(sample_loops.truth(loop))) == lm.datasets.truth(loop.tag)


@pytest.mark.statistics
@pytest.mark.parametrize("name", lm.datasets.names())
def test_diagnosed_rightly(name):
    record, truth = lm.datasets.load(name), lm.datasets.truth(name)
    assert (record.tag, len(record), record.op_unit) == (name, 2000, "%")
    found = lm.diagnose(record)
    assert found.verdict == truth["verdict"]
    assert found.confidence > 0.5
    if truth["size"] is not None:
        low, high = found.interval
        assert low <= truth["size"] <= high
        assert high - low < truth["size"]
