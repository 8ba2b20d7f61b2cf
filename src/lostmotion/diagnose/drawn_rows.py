"""What a diagnosis may say of a record of which a historian made up a part."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.diagnose.verdict import Verdict
from lostmotion.identify import HammersteinFit

# Share of the rows of PV made up, from which on no valve is accused: of 8 sound ones in another simulation with
# 81 to 87 % four were; the four faulty ones, with 59 to 76 %, rightly (docs/other-simulation.md).
MOST_FOR_A_KIND = 0.8
BETWEEN = "the loop does much of its answer between the rows, which do not show how far OP goes there"
RAW = "Export raw values from the control system or the historian, with compression off, and diagnose them."


def hidden_size(fit: HammersteinFit) -> str:
    """Why the record of a fit tells no size; empty where it does."""
    made_up = fit.data.made_up
    said = None if made_up is None else made_up.hides_size(fit.evidence.closed_loop)
    if said is not None:
        return said[1]
    return BETWEEN if fit.data.unseen.hides_size and fit.kind.sticks else ""


def drawn_share(fit: HammersteinFit) -> float:
    """Share of the rows of PV that a historian made up, where it is too much to accuse a valve; else 0."""
    share = 0.0 if fit.data.made_up is None else fit.data.made_up.pv.share
    return share if share > MOST_FOR_A_KIND else 0.0


def unless_drawn(verdict: Verdict, fit: HammersteinFit) -> Verdict:
    """The verdict, or "cannot tell" where it accuses a valve from rows that nobody measured; limits are seen in OP."""
    share = drawn_share(fit)
    if verdict.kind != "actuator" or verdict.verdict == "saturation" or not share:
        return verdict
    why = f"{100.0 * share:.0f} % of the rows of PV are a historian's, behind which healthy valves seem to stick"
    return replace(verdict, verdict="cannot tell", kind="unknown", why=why, advice=(RAW,))
