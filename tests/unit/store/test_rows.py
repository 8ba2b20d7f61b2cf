"""What a row of the store says of itself."""

from lostmotion.store.rows import UNDATED, AssessmentRow


def test_a_loop_is_cleared_up_to_the_tolerance_that_it_was_assessed_with():
    """0.5 of an OP of 0 to 20 is 2.5 %."""
    given = {"verdict": "other oscillation", "indices": {"tolerance": 0.5, "op_span": 20.0}}
    rows = [AssessmentRow("FIC-1", UNDATED, UNDATED, excluded_percent=excluded, **given) for excluded in (2.5, 2.6)]
    assert [row.cleared for row in rows] == [True, False]
