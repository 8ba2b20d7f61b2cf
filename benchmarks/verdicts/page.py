"""Tables of docs/diagnosis.md."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import numpy as np

from lostmotion.diagnose.diagnosis import verdicts
from lostmotion.evaluate.random_faults import CAUSES
from lostmotion.identify.actuators.kind import faults
from verdicts.calibrate import SOUND
from verdicts.cases import Row

LOST = ("dead zone", "backlash", "stiction")


def confusion(rows: list[Row]) -> str:
    """Truth against verdict."""
    lines = ["| truth | " + " | ".join(verdicts()) + " | all |", "|---" * (len(verdicts()) + 2) + "|"]
    for cause in CAUSES:
        counts = Counter(row.verdict for row in rows if row.truth == cause)
        lines.append(f"| {cause} | " + " | ".join(str(counts[v] or ".") for v in verdicts()) + f" | {counts.total()} |")
    return "\n".join(lines)


def scores(rows: list[Row]) -> dict[str, tuple[int, int]]:
    """Hits and cases of each bar."""
    lost = [row for row in rows if row.truth in LOST]
    wide = [row for row in lost if row.width > 2.0 * row.noise_in_op]
    seen = [row for row in lost if row.visible]
    told = [row for row in seen if row.told]
    named = [row for row in wide if row.verdict == row.truth]
    sized = [row for row in named if abs(row.found / row.width - 1.0) < 0.15]
    faulty = [kind.name for kind in faults()]
    sound = [row for row in rows if row.truth in SOUND]
    alarms = [row for row in sound if row.verdict in faulty]
    claimed = [row for row in wide if row.verdict in faulty]
    return {
        "kind right, width over twice the noise in OP": (len(named), len(wide)),
        "kind right, and OP turned by more than the width": (sum(row.verdict == row.truth for row in seen), len(seen)),
        "kind right, and the record tells it": (sum(row.verdict == row.truth for row in told), len(told)),
        "kind right where an actuator fault was named": (
            sum(row.verdict == row.truth for row in claimed),
            len(claimed),
        ),
        "width within 15 %, where the kind is right": (len(sized), len(named)),
        "false alarms: healthy, badly tuned, disturbed": (len(alarms), len(sound)),
    }


def score_table(rows: list[Row]) -> str:
    lines = ["| what | cases | share |", "|---|---|---|"]
    for name, (hits, cases) in scores(rows).items():
        lines.append(f"| {name} | {hits} of {cases} | {100 * hits / max(cases, 1):.1f} % |")
    seconds = np.array([row.seconds for row in rows if row.seconds > 0])
    lines.append(
        f"| processor time for 2,000 samples, median (worst) | {np.median(seconds):.2f} s ({seconds.max():.2f} s) | |"
    )
    return "\n".join(lines)


def loop_table(found: list[tuple[str, str, list[Row], str]], together: Mapping[str, str]) -> str:
    """Physical loops; of one with a single run also probability and size, of others what their runs say together."""
    lines = ["| loop | label | runs | verdicts | probability | size, % of span | right |", "|---" * 7 + "|"]
    for name, label, rows, right in found:
        counts = Counter(_verdict(row) for row in rows).most_common()
        said = ", ".join(verdict if len(rows) == 1 else f"{verdict} {count}" for verdict, count in counts)
        said += f"; together {together[name]}" if name in together else ""
        only = rows[0] if len(rows) == 1 else None
        chance = "-" if only is None or not only.probabilities else f"{only.probabilities['actuator']:.2f}"
        size = "-" if only is None or not np.isfinite(only.severity) else f"{only.severity:.2g}"
        mark = "**no**" if right == "no" else right
        lines.append(f"| {name} | {label} | {len(rows)} | {said} | {chance} | {size} | {mark} |")
    return "\n".join(lines)


def _verdict(row: Row) -> str:
    return row.verdict if row.kind in ("actuator", "none", "unknown") else f"{row.verdict} ({row.kind})"


def tally(sets: dict[str, list[tuple[str, str, list[Row], str]]]) -> str:
    """Of each set: loops, right of those told, and how many were left open or refused."""
    lines = ["| set | loops | right of those told | left open |", "|---|---|---|---|"]
    for name, found in sets.items():
        counts = Counter(right for *_, right in found)
        told = f"{counts['yes']} of {counts['yes'] + counts['no']}"
        lines.append(f"| {name} | {len(found)} | {told} | {counts['open'] + counts['refused']} |")
    return "\n".join(lines)
