import numpy as np
import pytest

import lostmotion as lm
from tests.unit.diagnose.test_pooled_diagnosis import response

pytestmark = pytest.mark.statistics

VALVES, RECORDS, ROWS = 3, 4, 400


@pytest.mark.long
def test_the_size_of_many_records_is_nearer_and_its_interval_holds():
    pooled, single, inside = [], [], 0
    for valve in range(VALVES):
        width = 0.6 + 0.5 * valve
        found = lm.diagnose([response(100 * valve + number, ROWS, width) for number in range(RECORDS)])
        assert found.verdict == "backlash"
        pooled.append(found.size / width - 1.0)
        single += [one.size / width - 1.0 for one in found.diagnoses if np.isfinite(one.size)]
        inside += found.interval[0] <= width <= found.interval[1]
    assert np.sqrt(np.mean(np.square(pooled))) < 0.7 * np.sqrt(np.mean(np.square(single)))
    assert inside >= VALVES - 1


@pytest.mark.long
def test_sound_valves_are_not_accused():
    for valve in range(2):
        found = lm.diagnose([response(900 + 10 * valve + number, ROWS, 0.0) for number in range(RECORDS)])
        assert found.verdict == "none"
        assert max(found.excluded.values()) < found.tolerance
