import json

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.compensate import DeadZoneCompensator
from lostmotion.models import DeadZone
from tests.properties.strategies import dead_zones, points

values = st.lists(points, min_size=1, max_size=20).map(np.array)
inside = st.floats(0, 1)


def rounding(zone, v):
    """What rounding of u to double precision does to x."""
    reach = max(abs(zone.left), abs(zone.right))
    steepest = max(zone.left_slope, zone.right_slope)
    return 4 * np.finfo(float).eps * (np.abs(v).max() + steepest * reach) + 1e-300


@given(dead_zones(), values)
def test_lemma_1_inverse_then_dead_zone_changes_nothing(zone, v):
    np.testing.assert_allclose(zone(zone.inverse()(v)), v, rtol=1e-14, atol=rounding(zone, v))


@given(dead_zones(), points, points)
def test_inverse_is_monotone(zone, one, other):
    low, high = sorted((one, other))
    undo = zone.inverse()
    assert undo(low) <= undo(high)


@given(dead_zones())
def test_answer_to_zero_lies_in_the_dead_zone_nearest_to_zero(zone):
    at_zero = zone.inverse().at_zero
    assert zone.left <= at_zero <= zone.right
    assert abs(at_zero) == min(abs(point) for point in (zone.left, zone.right, at_zero))
    assert zone.inverse()(0.0) == at_zero
    assert zone(at_zero) == 0.0


@given(dead_zones(), points, points)
def test_dead_zone_is_monotone_and_lipschitz(zone, one, other):
    low, high = sorted((one, other))
    rise = zone(high) - zone(low)
    assert rise >= 0
    steepest = max(zone.left_slope, zone.right_slope)
    size = max(abs(low), abs(high), abs(zone.left), abs(zone.right))  # u - left is rounded at the size of both
    assert rise <= steepest * (high - low) + 1e-14 * steepest * size


@given(dead_zones(), inside)
def test_nothing_passes_inside(zone, share):
    u = min(max(zone.left + share * zone.width, zone.left), zone.right)
    assert zone(u) == 0.0


@given(dead_zones(), st.floats(1e-3, 1e6))
def test_slopes_outside(zone, step):
    np.testing.assert_allclose(zone(zone.right + step), zone.right_slope * ((zone.right + step) - zone.right))
    np.testing.assert_allclose(zone(zone.left - step), zone.left_slope * ((zone.left - step) - zone.left))


@given(dead_zones(), values)
def test_arrays_are_scalars_side_by_side(zone, u):
    np.testing.assert_array_equal(zone(u), [zone(float(value)) for value in u])
    square = np.stack([u, -u])
    assert zone(square).shape == square.shape
    np.testing.assert_array_equal(zone(square)[1], zone(-u))


@given(dead_zones(), values)
def test_mirror(zone, u):
    mirrored = DeadZone(-zone.right, -zone.left, zone.right_slope, zone.left_slope)
    np.testing.assert_array_equal(mirrored(-u), -zone(u))


@given(dead_zones())
def test_description_survives_json(zone):
    data = json.loads(json.dumps(zone.to_dict()))
    assert data.pop("kind") == "dead zone"
    assert DeadZone(**data) == zone
    assert zone.inverse().inverse() == zone


@given(dead_zones(), values, points)
def test_compensator_step_is_call(zone, uc, centre):
    block = DeadZoneCompensator(zone, centre)
    stepped = []
    for value in uc:
        block.reset()
        stepped.append(block.step(float(value)))
    np.testing.assert_array_equal(stepped, block(uc))


@given(dead_zones(), values)
def test_compensator_with_centre_zero_is_the_inverse(zone, uc):
    np.testing.assert_array_equal(DeadZoneCompensator(zone)(uc), zone.inverse()(uc))


@given(dead_zones(), points, st.floats(1e-6, 1e6))
def test_compensator_steps_across_the_whole_dead_zone(zone, centre, distance):
    block = DeadZoneCompensator(zone, centre)
    assert block(centre) == block.at_zero
    assert zone.left <= block.at_zero <= zone.right
    assert block(centre + distance) >= zone.right
    assert block(centre - distance) <= zone.left
