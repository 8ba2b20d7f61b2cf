"""An identification as text: finding first, then numbers, checks and what was assumed."""

from __future__ import annotations

import textwrap

import numpy as np

from lostmotion.diagnose.clean_bill import clean_bill
from lostmotion.diagnose.evidence_words import probability
from lostmotion.diagnose.excitation import what_moves_op
from lostmotion.diagnose.op_span import OpSpan
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.identify.earned import fit_without_drift
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.identify.seen_position import shown_by_position
from lostmotion.report.digits import bracketed, digits, error_of, span
from lostmotion.report.seen_in_position import seen_in_position

WIDTH = 96
UNEARNED = (
    Status.CANNOT_TELL, Status.SAME_SIGNAL, Status.OTHER_KIND, Status.NEAR_RANGE, Status.NO_PROCESS,
    Status.NOT_REPRODUCED,
)  # fmt: skip
MEANING = {
    "gain": "static gain of the linear part",
    "offset": "PV at rest inside the dead zone",
    "load": "constant load, in units of OP",
}
STATISTICAL = (
    "Intervals of this table are statistical: they hold if the valve is what the model is. That of the size above also "
    "counts what real friction is beside it."
)
OF_PV, WITHOUT = ("offset",), ("slope_ratio", "left_slope", "right_slope")  # all else but the gain is in units of OP


def fit_summary(fit: HammersteinFit) -> str:
    """Report of a fit as plain text."""
    parts = [head(fit), _finding(fit), _table(fit), fill(dynamics(fit)), _checks(fit), _assumed(fit)]
    return "\n".join(part for part in parts if part)


def head(fit: HammersteinFit, of: str = "") -> str:
    """Name and size of the record, with what it is `of`, and a line under it."""
    data = fit.data
    name = data.tag or data.source or "record"
    pieces = f" in {len(data.segments)} pieces" if len(data.segments) > 1 else ""
    reach = f"{float(data.u.min()):.5g} .. {float(data.u.max()):.5g}{bracketed(data.op_unit)}"
    return f"{name}: {data.u.size} samples every {data.dt:g} s{pieces}{of}, OP {reach}\n{'=' * WIDTH}"


def _finding(fit: HammersteinFit) -> str:
    return fill(f"{fit.status.name}: {sentence(fit)}") + "\n" + fill(finding(fit))


def sentence(fit: HammersteinFit) -> str:
    """The sentence of the status; that of a dead zone is reworded for other kinds and for what was already done."""
    kind, compared, other = fit.kind, fit.kinds is not None, fit.evidence.other_kind
    if fit.status is Status.OTHER_KIND and other is not None and shown_by_position(fit):
        return f"PV does not show it, but the measured position shows {other[0]} (`fit.actuator`)."
    if fit.status is Status.OTHER_KIND and other is not None:
        return (
            f"Converged, but {other[0]} fits better by {other[1]:.0f} (log-likelihood, less what parameters cost) than "
            f"the {kind.name} that was asked for; use nonlinearity='auto'."
        )
    if fit.status is Status.MISFIT and (not kind.dead_between or compared):
        rest = _others(fit) if compared else 'compare the other kinds (nonlinearity="auto")'
        linear = kind.name == NO_FAULT
        what = "the process is not quite linear" if linear else "the real actuator is not quite of this shape"
        return f"Converged, but the residuals still depend on OP: {what}. Read the numbers as the nearest; {rest}."
    if fit.status is Status.NOT_SEEN and not kind.dead_between:
        return (
            f"No {kind.name} can be seen: a linear model explains the record as well. "
            "If you suspect one, record moves of OP that cross it many times, there and back."
        )
    if fit.status is Status.COLOURED and fit.settings["noise"] == "auto":
        return (
            "Converged, but the residuals are not white, so the intervals are too narrow: no noise order that was "
            "tried makes them so. Look for made-up samples, disturbances that come and go, or a second fault."
        )
    return fit.message


def _others(fit: HammersteinFit) -> str:
    kinds = fit.kinds
    if kinds is None or not _foretells_worse(kinds):
        return "no other kind did better"
    return "no other kind fitted better, and rows that were left out do not confirm this one"


def _foretells_worse(kinds: KindChoice) -> bool:
    """Whether the likeliest kind is a fault, and predicts rows that were left out worse than the linear model."""
    return kinds.best not in (NO_FAULT, kinds.runner_up) and kinds.gains[kinds.best] <= 0.0


def finding(fit: HammersteinFit) -> str:
    """What was found, in one sentence with its number."""
    kind = fit.nonlinearity.kind
    if fit.status in UNEARNED:
        return _unearned(fit)
    if kind == NO_FAULT and fit.kinds is None:
        return "Linear model, as requested."
    if kind == NO_FAULT and fit.preferred == "none":
        return "Linear model, no actuator fault in it." + _bound(fit) + _choice(fit)
    if kind == NO_FAULT:
        return "Linear model: a fault is neither shown nor excluded." + _choice(fit)
    span_op = _op_span(fit)
    if fit.status is Status.NOT_SEEN:
        return _unseen(fit, span_op)
    if fit.status is Status.ONE_SIDED and fit.kind.dead_between:
        side = "right" if "left" in fit.unvisited else "left"
        shown, deviation = digits(fit.parameters[side], fit.standard_errors[side])
        where = f"{shown} +/- {deviation}{bracketed(fit.data.op_unit)}"
        return f"The {side} break point may be at {where}; the width is not known."
    gain = f"{fit.evidence.gain_over_linear:.0f}"
    return f"{_size(fit, span_op)}; preferred to the linear model by {gain} (BIC; 10 is strong)." + _choice(fit)


def _bound(fit: HammersteinFit) -> str:
    """Size above which a lost motion would have been seen; empty where the record excludes none."""
    op = fit.data.op_span or (float(fit.data.u.min()), float(fit.data.u.max()))
    kind, size = clean_bill(fit, 0.01, OpSpan(*op, known=True), fit.evidence.only_fed_back).largest
    if not np.isfinite(size):
        return " The record does not bound the size of a lost motion."
    bound = f"{size:.2g}{bracketed(fit.data.op_unit)}{_percent(size, _op_span(fit))}"
    return f" A lost motion above {bound} would have been seen (95 %, {kind})."


def _unearned(fit: HammersteinFit) -> str:
    """What is not to be read into the numbers."""
    if fit.actuator is not None and shown_by_position(fit):
        return seen_in_position(fit.actuator, fit.preferred)
    if fit.kind.name == NO_FAULT:
        return "A fault is neither shown nor excluded."
    return f"{'No number is given for the' if fit.status in HIDDEN else 'Build nothing on this'} {fit.kind.name}."


def _unseen(fit: HammersteinFit, span_op: float | None) -> str:
    """What would have been seen."""
    kind = fit.kind
    if kind.size is None:
        return kind.words.unseen
    if fit.evidence.only_fed_back:
        moved = what_moves_op(fit.data.sp)
        return f"{moved[0].upper()}{moved[1:]} in this record, which then does not bound the {kind.size}."
    if fit.evidence.foreknown:
        return f"The controller knows more than the rows of this record, which then does not bound the {kind.size}."
    if not fit.evidence.answered:
        return f"PV answers nothing that is new in OP in this record, which then does not bound the {kind.size}."
    if fit.widest is None or not np.isfinite(fit.widest):
        return f"The record does not bound the {kind.size}."
    bound = f"{fit.widest:.2g}{bracketed(fit.data.op_unit)}{_percent(fit.widest, span_op)}"
    kink = ""
    if fit.evidence.gain_over_linear > 0 and kind.dead_between:
        kink = " The gain differs between low and high OP, but without a dead zone between them."
    return f"{kind.words.wider} {bound} would have been seen (95 %).{kink}"


def _size(fit: HammersteinFit, span_op: float | None) -> str:
    """Kind and size with the interval."""
    kind, name, unit = fit.kind, fit.kind.size, bracketed(fit.data.op_unit)
    if name is None:
        ends = " and ".join(f"{fit.parameters[one]:.5g}" for one in kind.model.own)
        return f"{kind.name.capitalize()} at {ends}{unit}"
    value, interval = fit.parameters[name], fit.size_interval
    error = error_of(interval, fit.standard_errors[name])
    shown, deviation = digits(value, error)
    text = (
        f"{kind.name.capitalize()} of {name} {shown} +/- {deviation}{unit}{_percent(value, span_op)}, "
        f"95 % interval {span(*interval, error)}{unit}"
    )
    if kind.nests:
        extra = kind.model.own[-1]
        text += f", {kind.words.extra} {digits(fit.parameters[extra], fit.standard_errors[extra])[0]}{unit}"
        if fit.interval(extra)[0] <= 0.0:
            text += f" (not told from none: {kind.nests} would do as well)"
    return text


def _choice(fit: HammersteinFit) -> str:
    """How sure the kind is."""
    kinds = fit.kinds
    if kinds is None or kinds.best == kinds.runner_up:
        return ""
    sure = f"confidence {probability(kinds.confidence)}"
    if kinds.best not in (NO_FAULT, fit.kind.name):
        ahead = kinds.likelihoods[kinds.best]
        return f" The likeliest of the kinds, {kinds.best}, gains {ahead:.0f} in log-likelihood, but shows no size."
    if kinds.best == NO_FAULT:
        return f" The nearest fault, {kinds.runner_up}, does not pay for its parameters ({sure})."
    ahead = kinds.likelihoods[kinds.best] - kinds.likelihoods[kinds.runner_up]
    what = "the linear model" if kinds.runner_up == NO_FAULT else kinds.runner_up
    if ahead <= 0.0:
        return f" {what.capitalize()} is as likely, but {kinds.best} is the simpler of the two ({sure})."
    left_out = kinds.gains[kinds.best]
    if _foretells_worse(kinds):
        return (
            f" Of the kinds, {kinds.best} fits best; next is {what}, {ahead:.1f} behind in log-likelihood ({sure} "
            f"among the kinds, which is not that of a fault). But rows that were left out it predicts worse than "
            f"the linear model, by {abs(left_out):.1f}."
        )
    return (
        f" Of the kinds, {kinds.best} is the likeliest; next is {what}, {ahead:.1f} behind in log-likelihood ({sure}). "
        f"Rows that were left out it predicts better than the linear model, by "
        f"{abs(left_out):.1f}."
    )


def _table(fit: HammersteinFit) -> str:
    lines = [f"{'':14}{'estimate':>14}{'std. error':>13}   {'95 % interval':<26}"]
    lines.append("-" * WIDTH)
    for name, value, deviation, between, said in parameter_rows(fit):
        lines.append(f"{name:14}{value:>14}{deviation:>13}   {between:<26}{said}")
    if fit.shown_size is not None and fit.kind.sticks:
        lines.append(fill(STATISTICAL))
    return "\n".join(lines)


def parameter_rows(fit: HammersteinFit) -> list[tuple[str, str, str, str, str]]:
    """Name, estimate, standard error, interval and meaning of each parameter that may be shown."""
    rows = []
    hidden = fit.status in HIDDEN
    size = fit.kind.size
    for name, meaning in {**fit.kind.words.meanings, **MEANING}.items():
        if name not in fit.parameters or (hidden and name not in (size, "gain")):
            continue
        source = fit.linear_alternative if hidden and name == "gain" and fit.linear_alternative is not None else fit
        interval = source.interval(name)
        error = source.standard_errors[name]
        error = error_of(interval, error) if name == size else error
        value, deviation = digits(source.parameters[name], error)
        if (hidden and name == size) or name in fit.unvisited:
            value, deviation = "not seen", ""
        between = "" if deviation == "given" else span(*interval, error)
        elsewhere = name == "offset" and not fit.kind.family.relative
        said = "PV at rest where x = 0 (extrapolated)" if elsewhere else meaning
        rows.append((name, value, deviation, between, f"{said}{bracketed(_unit(fit, name))}"))
    return rows


def _unit(fit: HammersteinFit, name: str) -> str:
    """Engineering unit of a parameter, where the record has it."""
    op, pv = fit.data.op_unit, fit.data.pv_unit
    if name in WITHOUT:
        return ""
    if name == "gain":
        return f"{pv} per {op}" if op and pv else ""
    return pv if name in OF_PV else op


def dynamics(fit: HammersteinFit) -> str:
    """Linear part, noise and how well PV is simulated, in sentences."""
    chosen = fit.chosen
    poles = fit.linear.poles
    if chosen.integrating:
        poles = np.delete(poles, np.argmin(np.abs(poles - 1.0)))
    constants = [
        f"{-fit.data.dt / np.log(abs(pole)):.3g} s" for pole in poles if 1e-9 < abs(pole) < 1 and pole.imag >= 0
    ]
    return (
        f"Linear part{' (integrating)' if chosen.integrating else ''}: na = {chosen.na}, nb = {chosen.nb}, "
        f"delay {chosen.delay} samples "
        f"({chosen.delay * fit.data.dt:g} s), time constants {', '.join(constants) or 'none'}. "
        f"Noise: {_noise_words(fit)}, "
        f"deviation of the prediction errors {np.sqrt(fit.noise.variance):.3g}{bracketed(fit.data.pv_unit)}. "
        f"Simulated from OP alone the model fits {fit.fit_percent:.1f} % of PV{_below_zero(fit)}."
    )


def _noise_words(fit: HammersteinFit) -> str:
    """Its model."""
    zero, order = fit.chosen.noise_zero, fit.chosen.noise_order
    if fit.evidence.load_drifts:
        return "a drifting load disturbance and white measurement noise"
    return f"ARMA of order ({order}, 1), zero at {zero:g}" if zero else f"AR of order {order}" if order else "white"


def _below_zero(fit: HammersteinFit) -> str:
    """Why a model can be good and its simulation far from PV: drift, which OP holds back in a loop."""
    if fit.fit_percent > 0.0:
        return ""
    data = fit.data
    follows = fit_without_drift(data.y, fit.simulated, data.segments)
    text = f", and {follows:.0f} % where a straight line in every cycle of PV does not count"
    if follows <= 0.0 or not fit.evidence.closed_loop:
        return text
    return text + ": OP holds back a disturbance in this loop that drifts, which the simulation does not know"


def _checks(fit: HammersteinFit) -> str:
    tests, evidence = fit.tests, fit.evidence
    text = (
        f"Residuals: whiteness p = {tests.whiteness_p:.2g}, better static shape p = {tests.shape_p:.2g} "
        f"(it would explain {100 * tests.shape_share:.1f} % of the prediction errors, "
        f"{100 * tests.static_share:.1f} % of the output residual). "
    )
    if fit.kind.dead_between:
        text += f"Samples beyond the break points: {evidence.samples_left} left, {evidence.samples_right} right. "
    if evidence.only_fed_back:
        text += (
            f"OP is an exact function of PV but for {100 * evidence.free_moves:.1g} % of its moves: a linear process "
            "cannot be told from the inverse of the controller here, so dynamics and gain rest on the nonlinearity "
            "alone. Record set-point moves. "
        )
    if fit.fit_percent < 20:
        text += (
            "The simulated fit is low: most of PV is disturbance, the numbers rest on the prediction errors; "
            "a test with OP moves of your own would confirm them. "
        )
    if evidence.rivals and fit.preferred == fit.kind.name:
        others = ", ".join(f"{left:.3g} .. {right:.3g} ({behind:.0f})" for left, right, behind in evidence.rivals[:3])
        text += f"Beware: other {fit.kind.words.plural} fit about as well: {others} (BIC behind the one reported). "
    return fill(text)


def _assumed(fit: HammersteinFit) -> str:
    settings = fit.settings
    said = []
    if fit.kind.has_slopes and settings["gain"] is None:
        said.append("right_slope = 1 by convention (gain unknown; it stays in the linear part)")
    if fit.chosen.integrating:
        said.append("no offset: the level of an integrating process is its initial state")
    elif settings["offset_fixed"]:
        said.append("offset 0: the record is in deviations, or was told to be")
    auto = [name for name in ("orders", "noise") if settings[name] == "auto"]
    if auto:
        said.append(f"{' and '.join(auto)} chosen from the data")
    said.append("OP is held between samples and not clipped")
    lines = [fill("Assumed: " + "; ".join(said) + ".")]
    lines += [fill("Note: " + note) for note in (*fit.data.notes, *fit.remarks)]
    lines.append(f"Data fingerprint {fit.data.fingerprint}.")
    return "\n".join(lines)


def _op_span(fit: HammersteinFit) -> float | None:
    span_op = fit.data.op_span
    return None if span_op is None else span_op[1] - span_op[0]


def _percent(value: float, span_op: float | None) -> str:
    return "" if span_op is None else f" ({100 * value / span_op:.2g} % of the OP span)"


def fill(text: str) -> str:
    """Lines of at most WIDTH; a number stays with its per cent sign or its unit."""
    held = text.replace(" %", "\u00a0%").replace(" [", "\u00a0[")
    return textwrap.fill(held, WIDTH, subsequent_indent="  ").replace("\u00a0", " ")
