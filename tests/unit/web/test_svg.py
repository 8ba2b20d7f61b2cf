"""A trend as SVG: what is drawn of PV over OP."""

import re

import numpy as np
import pytest

from lostmotion.records import LoopRecord
from lostmotion.web.trend.columns import Columns
from lostmotion.web.trend.svg import plane


@pytest.mark.parametrize("dt", [0.1, 1.0, 10.0])
def test_every_row_is_a_point_of_pv_over_op_whatever_the_sampling_time(dt):
    op = np.arange(6.0)
    drawn = plane(Columns.of(LoopRecord(op, 2.0 * op, dt=dt)), 0, 6, None, None)
    assert re.findall(r'class="faint" d="([^"]+)"', drawn) == ["M91 955 455 773 818 591 1182 409 1545 227 1909 45"]
