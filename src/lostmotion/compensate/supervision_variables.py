"""Every variable of the supervision of a block: the same names for all kinds, so one faceplate serves all."""

from __future__ import annotations

from lostmotion.compensate.variables import OP, Variable

STATES = ("passive", "requested", "accepted", "active", "shed")
"""SUPERVISION by number; "accepted" is armed but not enabled."""

REFUSALS = (
    "none",
    "id not above all before, or beyond 4000000",
    "checksum",
    "beyond the limits set in the PLC",
    "too large a change",
    "too soon after the last accept",
    "not ready: see link, quality, mode, error",
    "changed while it was shown",
    "withdrawn",
    "accepted before it was shown long enough",
    "not accepted in time",
)
"""REFUSAL by number."""

REASONS = (
    "none",
    "first scan",
    "heartbeat",
    "bad quality",
    "manual",
    "not automatic",
    "cascade broken",
    "limits set in the PLC",
    "settings refused by the block",
)
"""SHED_REASON by number."""


def listed(words: tuple[str, ...]) -> str:
    """Words with their numbers, in one line."""
    return ", ".join(f"{number} {word}" for number, word in enumerate(words))


def _rows(section: str, *rows: tuple[str, str, str, str] | tuple[str, str, str, str, float]) -> list[Variable]:
    return [Variable(row[0], section, *row[1:]) for row in rows]


def supervision(first: str, second: str) -> tuple[Variable, ...]:
    """Variables of the supervision, where `first` and `second` say what the two widths of the kind are."""
    step = "whole numbers of RESOLUTION"
    return (
        *_rows(
            "parameter",
            ("TIMEOUT", "int", "scans", "without a change of the heartbeat, then the block is shed", 10.0),
            ("SHOW_SCANS", "int", "scans", "that a request must have been shown before an accept counts", 2.0),
            ("ACCEPT_SCANS", "int", "scans", "that a request waits for an accept", 600.0),
            ("LEAST_SCANS", "int", "scans", "from one accept to the next request", 60.0),
            ("BLOCK_KEY", "int", "", "number of this block, 0 .. 524286, the start of the checksum"),
            ("RESOLUTION", "real", OP, "one unit of what is asked, of the factor too", 0.001),
            ("FIRST_RANGE", "real", OP, f"largest distance from what is set here: {first}"),
            ("SECOND_RANGE", "real", OP, f"largest distance from what is set here: {second}"),
            ("MOST_CHANGE", "real", OP, "largest change of a width by one request"),
        ),
        *_rows(
            "input",
            ("REQUEST_ID", "int", "", "number of the request, above all before; 0 withdraws. Written last"),
            ("ASKED_FACTOR", "int", step, "share of the lost motion, at most what is set here as factor"),
            ("ASKED_FIRST", "int", step, first),
            ("ASKED_SECOND", "int", step, second),
            ("CHECKSUM", "int", "", "of block key, id, factor, first and second"),
            ("HEARTBEAT", "int", "", "0 .. 4000000, changes while the supervisor lives"),
            ("ACCEPT", "bool", "", "the operator's word, an edge, given where the plant is operated"),
            ("AUTO_MODE", "bool", "", "the controller is automatic"),
            ("CASCADE", "bool", "", "the cascade around the loop is closed, TRUE where there is none"),
        ),
        *_states(),
        *_rows(
            "output",
            ("SUPERVISION", "int", "", listed(STATES)),
            ("REFUSAL", "int", "", f"of the last request: {listed(REFUSALS)}"),
            ("SHED_REASON", "int", "", listed(REASONS)),
            ("WAITING", "bool", "", "a checked request waits for the operator"),
            ("LINK_OK", "bool", "", "the heartbeat changes"),
            ("ECHO_ID", "int", "", "id of the last request that was looked at"),
            ("ECHO_FACTOR", "int", step, "factor of the last request that was found good"),
            ("ECHO_FIRST", "int", step, f"of the last request that was found good: {first}"),
            ("ECHO_SECOND", "int", step, f"of the last request that was found good: {second}"),
            ("FORCE_ID", "int", "", "id of what was accepted and is armed, 0 none"),
            ("FORCE_FACTOR", "real", "1", "factor in force, 0 while nothing is armed"),
            ("FORCE_FIRST", "real", OP, f"in force, 0 while nothing is armed: {first}"),
            ("FORCE_SECOND", "real", OP, f"in force, 0 while nothing is armed: {second}"),
        ),
    )


def _states() -> list[Variable]:
    """What the block remembers of its supervision."""
    return _rows(
        "state",
        ("SET_FIRST", "real", OP, "first width as it is set here"),
        ("SET_SECOND", "real", OP, "second width as it is set here"),
        ("BEGUN", "bool", "", "the first scan of the supervision is over"),
        ("LAST_BEAT", "int", "", "heartbeat that was seen last"),
        ("SILENT", "int", "scans", "since the heartbeat changed"),
        ("LINK", "bool", "", "the heartbeat changes"),
        ("FAILING", "int", "", f"what forbids to compensate: {listed(REASONS)}"),
        ("LAST_ID", "int", "", "largest id so far"),
        ("PENDING", "bool", "", "a request waits"),
        ("PEND_FACTOR", "int", "", "its factor"),
        ("PEND_FIRST", "int", "", "its first width"),
        ("PEND_SECOND", "int", "", "its second width"),
        ("PEND_SUM", "int", "", "its checksum"),
        ("SHOWN", "int", "scans", "since it came"),
        ("WAS_ACCEPT", "bool", "", "ACCEPT in the last scan"),
        ("EDGE", "bool", "", "ACCEPT has risen"),
        ("ARMED", "bool", "", "accepted values are in force"),
        ("SETTLED", "bool", "", "they have been in force for a scan"),
        ("WAS_SHED", "bool", "", "what was accepted has been taken away"),
        ("LOST", "int", "", "why"),
        ("REFUSED", "int", "", "why the last request was refused"),
        ("ACCEPTED_ID", "int", "", "id that was accepted last"),
        ("SINCE_ACCEPT", "int", "scans", "since the last accept, up to LEAST_SCANS"),
        ("ODD", "bool", "", "scratch: beyond limits"),
        ("SUM", "int", "", "scratch: checksum"),
        ("DIGIT", "int", "", "scratch: number on its way into the checksum"),
        ("SPAN", "real", "", "scratch: finite where all settings are"),
        ("NEW_FACTOR", "real", "1", "scratch: factor that is looked at"),
        ("NEW_FIRST", "real", OP, "scratch: first width that is looked at"),
        ("NEW_SECOND", "real", OP, "scratch: second width that is looked at"),
        ("USE_FACTOR", "real", "1", "factor in force"),
        ("USE_FIRST", "real", OP, "first width in force"),
        ("USE_SECOND", "real", OP, "second width in force"),
        ("RUN", "bool", "", "compensate"),
        ("KEEP", "bool", "", "keep the offset while the operator has switched off"),
        ("SHOW_ID", "int", "", "id in force"),
        ("SHOW_STATE", "int", "", "SUPERVISION"),
    )
