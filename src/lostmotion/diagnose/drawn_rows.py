"""What a diagnosis may say of a record of which a historian made up a part."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.diagnose.shown import MANY_LOADS, only_one_step_ahead
from lostmotion.diagnose.verdict import Verdict
from lostmotion.identify import HammersteinFit
from lostmotion.identify.data import IdentificationData

# Share of the rows of PV made up, from which on no valve is accused: of 8 sound ones in another simulation with
# 81 to 87 % four were; the four faulty ones, with 59 to 76 %, rightly (docs/other-simulation.md).
MOST_FOR_A_KIND = 0.8
BETWEEN = "the loop does much of its answer between the rows, which do not show how far OP goes there"
UNREPRODUCED = "with {} swings and steps of load the model foretells PV row by row, but OP alone reproduces none of it"
RAW = "Export raw values from the control system or the historian, with compression off, and diagnose them."


def hidden_size(fit: HammersteinFit) -> str:
    """Why the record of a fit tells no size; empty where it does."""
    if fit.kind.sticks and only_one_step_ahead(fit, MANY_LOADS):
        return UNREPRODUCED.format(len(fit.chosen.loads))
    return size_hidden_in(fit.data, fit.evidence.closed_loop, fit.kind.sticks)


def size_hidden_in(data: IdentificationData, closed_loop: bool, sticks: bool) -> str:
    """Why a record tells no size of a valve; empty where it does."""
    said = None if data.made_up is None else data.made_up.hides_size(closed_loop)
    if said is not None:
        return said[1]
    return BETWEEN if data.unseen.hides_size and sticks else ""


def drawn_share(data: IdentificationData) -> float:
    """Share of the rows of PV that a historian made up, where it is too much to accuse a valve; else 0."""
    share = 0.0 if data.made_up is None else data.made_up.pv.share
    return share if share > MOST_FOR_A_KIND else 0.0


def unless_drawn(verdict: Verdict, fit: HammersteinFit) -> Verdict:
    """The verdict, or "cannot tell" where it accuses a valve from rows that nobody measured; limits are seen in OP."""
    share = drawn_share(fit.data)
    if verdict.kind != "actuator" or verdict.verdict == "saturation" or not share:
        return verdict
    return replace(verdict, verdict="cannot tell", kind="unknown", why=of_a_historian(share), advice=(RAW,))


def of_a_historian(share: float) -> str:
    """Why no valve is accused of rows that nobody measured."""
    return f"{100.0 * share:.0f} % of the rows of PV are a historian's, behind which healthy valves seem to stick"
