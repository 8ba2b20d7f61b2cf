"""What a fit says about its data: resolution against noise, sampling against dynamics, numbers in % of span."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.seen_position import shown_by_position
from lostmotion.identify.unseen_moves import FILLED
from lostmotion.report.seen_in_position import seen_in_position

# Step of PV over the deviation of the noise, measured on the level tank (docs/records.md)
FELT_STEP = 1.0  # rounding adds a twelfth to the variance of the noise
COARSE_STEP = 2.0  # break points are off by up to half a standard error
BLIND_STEP = 4.0  # from here on by more, by many in a loop that rests inside the dead zone
FEW_LEVELS = 4.0  # steps of OP inside the dead zone
FAST = 40.0  # samples in the slowest time constant
WANTED = 10.0  # samples in it after resampling
FEWEST_LEFT = 300  # samples after resampling: fewer tell less
LEAST_REACH = 1e-4  # of the range of OP: a step of PV that less would make is one of a gain that is rounding
LATE = 20  # samples of delay
MOST_SAID = 3  # periods
LEAST_ASYMMETRY = 0.02  # of the speed of a lag: less is not worth a word
SLOW = 0.5  # samples in the slowest time constant
NO_LAG = 0.0483  # samples in the slowest time constant: its pole is below 1e-9, which is 0 but for rounding
NO_SIZE = (Status.NOT_SEEN, Status.CANNOT_TELL, Status.SAME_SIGNAL, Status.OTHER_KIND)  # of which nobody asks how wide
CALM = 0.02  # of the deviation of OP: more moves inside a block cost more than resampling brings (docs/records.md)


def fit_remarks(fit: HammersteinFit) -> tuple[str, ...]:
    """Sentences about the fit and its data, none where there is nothing to say.

    Parameters
    ----------
    fit : HammersteinFit
    """
    about = (
        about_position, about_pv_step, about_op_step, about_unseen_moves, about_lag, about_sampling, about_loads,
        about_break_away, about_characteristic, about_asymmetry, about_horizon, in_percent,
    )  # fmt: skip
    return tuple(sentence for sentence in (say(fit) for say in about) if sentence)


def step_over_noise(step: float, variance: float) -> float:
    """Step of PV over the deviation of the noise without the rounding, whose variance is step^2 / 12.

    Parameters
    ----------
    step : float
        Step of PV.
    variance : float
        Variance of the prediction errors, rounding included.

    Examples
    --------
    >>> round(step_over_noise(0.5, 0.25 + 0.5**2 / 12), 3)
    1.0
    """
    own = variance - step**2 / 12.0
    return float(step / np.sqrt(own)) if own > 0 else np.inf


def about_unseen_moves(fit: HammersteinFit) -> str:
    """What OP does between the rows, or may do there; of a dead zone where it is a part of the width that matters."""
    moves, size = fit.evidence.unseen_moves, fit.kind.size
    matters = size is not None and (fit.kind.sticks or moves > FILLED * fit.parameters[size] > 0.0)
    if moves <= 0.0 or not matters or fit.status in NO_SIZE:
        return ""
    return (
        f"{fit.data.unseen.words(moves)}, which makes the interval of the {fit.kind.size} so wide. Record every scan of"
        " the controller."
    )


def about_position(fit: HammersteinFit) -> str:
    """What the measured position shows, where that is not the finding."""
    return "" if fit.actuator is None or shown_by_position(fit) else seen_in_position(fit.actuator, fit.preferred)


def about_lag(fit: HammersteinFit) -> str:
    """Lag in front of the lost motion."""
    lag = fit.evidence.actuator_lag
    if lag <= 0.0:
        return ""
    return f"The actuator lags by about {lag:.2g} s before it sticks; its {fit.kind.size} is that behind this lag."


def about_loads(fit: HammersteinFit) -> str:
    """What else acts on the process, in the model that was chosen."""
    periods = [f"{period * fit.data.dt:.4g} s" for period in fit.chosen.periods]
    steps = fit.chosen.steps
    parts = [f"swings of {', '.join(periods[:MOST_SAID])}{' and more' * (len(periods) > MOST_SAID)}"] if periods else []
    if steps:
        parts.append(f"{steps} step{'s' * (steps > 1)}")
    return f"Beside the actuator {' and '.join(parts)} of load act on the process in this model." if parts else ""


def about_break_away(fit: HammersteinFit) -> str:
    """Of a dead zone that is left with a jump."""
    if fit.chosen.break_away is None:
        return ""
    ends = zip(fit.chosen.break_away, fit.chosen.break_away_intervals or ((), ()), strict=True)
    low, high = (f"{at:.4g}{f' ({ci[0]:.4g} to {ci[1]:.4g})' if ci else ''}" for at, ci in ends)
    return (
        f"The valve begins to move at OP {low} and {high}, and then with a jump: left and right are where the "
        "lines beyond reach zero. The inverse uses these lines; the valve cannot make moves smaller than the jump."
    )


def about_characteristic(fit: HammersteinFit) -> str:
    """Of a valve whose gain changes over its range."""
    slopes = fit.chosen.slopes
    if slopes is None:
        return ""
    low, high = np.quantile(fit.data.u, (0.01, 0.99)).tolist()
    return (
        f"The characteristic bends: about OP {low:.3g} valve and process have {slopes[0]:.2g} times the gain of this"
        f" model, about {high:.3g} {slopes[1]:.2g} times. Simulations take the gain of the model at any OP."
    )


def about_asymmetry(fit: HammersteinFit) -> str:
    """Of a lag that differs with direction."""
    if fit.chosen.asymmetry is None:
        return ""
    ways = zip(fit.chosen.asymmetry, ("upwards", "away from PV at OP 0"), ("downwards", "back to it"), strict=True)
    shares = [(share, fast, slow) if share > 0 else (-share, slow, fast) for share, fast, slow in ways]
    words = [
        f"{(1 + share) / (1 - share):.2g} times as fast {fast} as {slow}"
        for share, fast, slow in shares
        if LEAST_ASYMMETRY < share < 1.0
    ]
    found = f" ({', '.join(words)})" if words else ""
    return f"The lag of the process differs with direction{found}. Simulations use its mean."


def about_horizon(fit: HammersteinFit) -> str:
    """Where one-step predictions and free simulation do not agree."""
    if fit.evidence.by_prediction is None:
        return ""
    kind, size = fit.evidence.by_prediction
    before = kind if size is None else f"{kind} {size:.3g}"
    return (
        f"The result depends on the horizon: one-step predictions give {before}; simulation from OP alone gives "
        f"{fit.found_in_words}, with a smaller error on held-out samples, and is reported. The process is not quite of "
        "this model; the interval allows for coloured residuals."
    )


def about_pv_step(fit: HammersteinFit) -> str:
    """Quantisation of PV against the noise."""
    step = fit.data.y_step
    ratio = step_over_noise(step, fit.noise.variance)
    if ratio < FELT_STEP:
        return ""
    size = f"PV was stored in steps of {step:g}"
    reach, span = step_in_op(fit), float(np.ptp(fit.data.u))
    if reach > span:
        return (
            f"Beware: {size}, and all that OP moved would move PV at rest by less than one. The record tells nothing."
        )
    if reach > LEAST_REACH * span:
        size += f", which is what OP moves by {reach:.2g} at rest"
    rounding = step**2 / 12.0
    share = 100.0 * rounding / max(fit.noise.variance, rounding)  # 100 of an exact fit
    if ratio < COARSE_STEP:
        return f"{size}. Rounding makes {share:.0f} % of the variance of the noise; the intervals contain it."
    much = f"{ratio:.1f} times the deviation of the noise" if np.isfinite(ratio) else "all of the noise"
    harm = "half a standard error" if ratio < BLIND_STEP else "many standard errors"
    return (
        f"Beware: {size}, {much}. Rounding then is no noise: break points may be off by {harm}, which the intervals "
        "do not contain. Export PV with more decimals."
    )


def step_in_op(fit: HammersteinFit) -> float:
    """Step of PV in units of OP, through the static gain; 0 where the process integrates."""
    gain = abs(fit.linear.gain)
    return fit.data.y_step / gain if np.isfinite(gain) and gain > 0 else 0.0


def about_op_step(fit: HammersteinFit) -> str:
    """Levels of OP inside the dead zone."""
    step, width = fit.data.u_step, fit.parameters.get("width", 0.0)
    if not _is_gap(fit) or not 0.0 < width < FEW_LEVELS * step:
        return ""
    return (
        f"Beware: the {fit.preferred} is only {width / step:.1f} steps of OP ({step:g}) wide; its interval may be too "
        f"narrow. Less than {FEW_LEVELS:g} steps cannot be told for sure."
    )


def about_sampling(fit: HammersteinFit) -> str:
    """Sampling time against the slowest time constant and the delay."""
    dt = fit.data.dt
    slowest, delay = fit.linear.slowest_lag(within=np.exp(-1.0 / fit.data.u.size)), fit.linear.delay
    factor = calm_factor(fit.data.u, max(slowest, float(delay)) / WANTED)
    if (slowest > FAST or delay > LATE) and factor > 1:
        return (
            f"The sampling is fast for this process: {slowest:.0f} samples in its slowest time constant, {delay} in "
            f"its delay. Fewer samples tell as much, and sooner: resample by {factor}."
        )
    if NO_LAG < slowest < SLOW:
        return (
            f"The sampling is slow for this process: its slowest time constant is {slowest * dt:.2g} s, the sampling "
            f"time {dt:g} s. Moves of OP between the samples are not seen; record faster if OP moves faster."
        )
    return ""


def calm_factor(u: FloatArray, wanted: float) -> int:
    """Factor near the wanted one whose blocks OP hardly moves within; 1 where there is none.

    Examples
    --------
    >>> calm_factor(np.repeat(np.arange(300.0) % 3, 10), 4.0), calm_factor(np.arange(3000.0) % 7, 4.0)
    (5, 1)
    """
    near = range(max(round(0.5 * wanted), 2), min(round(1.5 * wanted), u.size // FEWEST_LEFT) + 1)
    if not near:
        return 1
    calmest = min(near, key=lambda factor: (round(moves_within(u, factor), 6), abs(factor - wanted)))
    return calmest if moves_within(u, calmest) < CALM else 1


def moves_within(u: FloatArray, factor: int) -> float:
    """Deviation of u from the first sample of its block, in deviations of u.

    Examples
    --------
    >>> moves_within(np.repeat(np.arange(10.0), 5), 5)
    0.0
    """
    blocks = u[: u.size // factor * factor].reshape(-1, factor)
    return float(np.sqrt(np.mean((blocks - blocks[:, :1]) ** 2)) / max(float(np.std(u)), 1e-300))


def in_percent(fit: HammersteinFit) -> str:
    """Break points and gain in % of the spans, where these are known."""
    span = fit.data.op_span
    if span is None or not _is_gap(fit):
        return ""
    low, size = span[0], (span[1] - span[0]) / 100.0
    ends = [(fit.parameters[name] - low) / size for name in fit.kind.break_points]
    said = f"In % of the OP span: {ends[0]:.3g} .. {ends[1]:.3g}, width {fit.parameters['width'] / size:.3g}"
    pv = fit.data.pv_span
    gain = fit.linear.gain
    if pv is not None and np.isfinite(gain):
        said += f"; gain {gain * size / ((pv[1] - pv[0]) / 100.0):.3g} % of the PV span per % of the OP span"
    return said + "."


def _is_gap(fit: HammersteinFit) -> bool:
    """Whether the record shows an actuator in which nothing moves between two places."""
    return fit.kind.dead_between and fit.preferred == fit.kind.name
