"""The manifest of quoted figures: which piece of which text has its figures from which page.

`README.md` may hold no number outside code that is neither here nor under GIVEN. ``python -m benchmarks.pages
--figures`` shows all pieces with the figures of today, ``--mend`` puts these into the texts.
"""

from __future__ import annotations

from collections.abc import Iterable

from .quotes import Quote
from .tables import PageText, QuoteError, numbers

OPEN = tuple(f"open loop, PRS, N = {n}, orders given" for n in ("2,000", "20,000"))
DAILY = tuple(f"routine closed loop, {drift} drift" for drift in ("mild", "strong"))
AS_PAPER = tuple(f"{row}, fitted as the paper's Output Error model" for row in DAILY)
RIGHT = "kind right where an actuator fault was named"
PAP4, MOTOR, POSITIONER = "ISDB PAP4", "DC motor", "DAMADICS"


def holds(true: bool, words: str) -> None:
    """Words without a figure that a page must bear out."""
    if not true:
        raise QuoteError(f"it no longer bears out {words!r}; write what it says")


def span(values: Iterable[float]) -> tuple[float, float]:
    """Least and largest."""
    found = list(values)
    return min(found), max(found)


def over(page: PageText, rows: Iterable[str], column: str) -> list[float]:
    """Numbers of a column in several rows."""
    return [number for row in rows for number in page.numbers(row, column)]


def pairs(values: list[float]) -> tuple[float, float]:
    """Sums of the first and of the second numbers of cells such as 3 of 7."""
    return sum(values[::2]), sum(values[1::2])


def all_converge(page: PageText, rows: Iterable[str]) -> None:
    """Every seed."""
    found, of = pairs(over(page, rows, "converged"))
    holds(found == of, "all converge")


def open_loop(page: PageText) -> list[float]:
    """Ratio to the bound and coverage."""
    all_converge(page, OPEN)
    return [*span(over(page, OPEN, "RMSE / bound")), *span(over(page, OPEN, "coverage, %"))]


def daily(page: PageText) -> list[float]:
    """Median errors, coverage, and median errors without a noise model."""
    ours, papers = ([page.number(row, "median error") for row in rows] for rows in (DAILY, AS_PAPER))
    return [*ours, *span(over(page, DAILY, "coverage, %")), *papers]


def family(page: PageText) -> list[float]:
    """Success, coverage, delay told, honest."""
    return [page.number("all", column) for column in ("success", "cover", "told", "honest")]


def recursive(page: PageText) -> list[float]:
    """Ratio to the bound, microseconds a sample, samples in a step of a plain RLS."""
    all_converge(page, ["20,000"])
    ratio = span(page.numbers("20,000", "RMSE / bound, offset known to be 0"))
    return [*ratio, page.number("`RecursiveML`", "`run`, per sample") / 1e3, page.number("`RecursiveML`", "RLS / this")]


def compensated(page: PageText) -> list[float]:
    """IAE, turns, and how wrong the width was at most while no limit cycle grew."""
    without = page.number("no compensation", "hold with guard")
    wrong = {row[0]: row for row in page.rows("compensated") if row[0].endswith("%")}
    larger = [name for name in wrong if page.number(name, "hold with guard") > without]
    holds(not larger, "no limit cycle larger than without compensation")
    worst = max(number for name in wrong for number in page.numbers(name, "compensated"))
    return [*page.said("IAE # % above the loop"), *page.said("# of its turns beyond the noise"), worst]


def exported(page: PageText) -> list[float]:
    """Scans."""
    holds(not any(over(page, [""], "largest difference")), "equal to the last bit")
    holds(not any(over(page, [""], "different flags")), "equal to the last bit")
    return [min(over(page, [""], "scans"))]


def against_plain(page: PageText, row: str) -> float:
    """Time of a row over that of the plain fit."""
    return page.number(row, "time") / page.number("plain `least_squares`, generic start", "time")


def speed(page: PageText) -> list[float]:
    """Samples, refinement and whole over the plain fit."""
    rows = (
        "inside the refinement of the dead zone, rough and final, noise white",
        "whole `identify`, orders given, noise white",
        "whole `identify`, everything auto",
    )
    return [*page.said("N = #"), *(against_plain(page, row) for row in rows)]


def diagnosed(page: PageText) -> list[float]:
    """Loops with a fault named, right ones; right where the record tells; false alarms; real loops."""
    told = pairs(page.numbers("kind right, and the record tells it", "cases"))
    right, named = pairs(page.numbers(RIGHT, "cases"))
    false, sound = pairs(page.numbers("false alarms", "cases"))
    real = [number for source in ("isdb26", "isdb_more", "sacac", "refinery") for number in real_loops(page, source)]
    return [named, right, *told, false, sound, *real]


def real_loops(page: PageText, source: str) -> list[float]:
    """Right of those told, and those left open, of one set."""
    return page.numbers(source, "right of those told") + page.numbers(source, "left open")


def sticking(page: PageText) -> list[float]:
    """Kinds named rightly; sizes within a percent; intervals that hold; their width."""
    named, within = page.numbers("stiction", "kind"), page.number("stiction", "within 1 %")
    play, held = page.numbers("backlash", "kind"), page.numbers("stiction", "held")
    return [*named, *play, within, *held, page.number("stiction", "width")]


def designed(page: PageText, target: str) -> tuple[float, float]:
    """Least and largest ratio of the intervals of a PRS and of the designed test."""
    rows = page.rows("PRS / designed: interval", target=target)
    return span(float(row[page.column("PRS / designed: interval")]) for row in rows)


def wrong_estimates(page: PageText) -> list[float]:
    """Wrong estimates and records."""
    larger, of = pairs(page.numbers("", "larger limit cycle"))
    return [larger, of, len(page.rows("larger limit cycle"))]


def blocks(page: PageText) -> list[float]:
    """How many, of how many faulty valves; error with them: median and ends; how many made worse; foretold right."""
    ended = [row for row in page.rows("a block") if not row[0].startswith(("sound", "all"))]
    of = sum(number for row in ended for number in numbers(row[1]))
    ratio = [page.number("all", "error ratio"), *page.numbers("all", "from .. to")]
    worse = page.cell("all", "made worse")
    ends = page.numbers("measured over foretold", "5 .. 95 %")
    return [page.number("all", "blocks"), of, *ratio, float(worse or 0), *ends]


QUOTES = (
    Quote("whose valve sticks by {:.2f} % of span", "readme-examples", lambda p: p.said("valve sticks by # % of span")),
    Quote(
        "Simulated with plants up to {:.0f} % away from the guess",
        "test-design",
        lambda p: p.said("up to # % of the half-width"),
    ),
    Quote(
        "the interval of the width is {:.1f} to {:.1f} times narrower than that of a PRS of the same length, range and "
        "shortest hold, that of the break points {:.1f} to {:.1f} times",
        "test-design",
        lambda p: [*designed(p, "width"), *designed(p, "break points")],
    ),
    Quote(
        "state file (about {:.1f} MB, however long the record)",
        "endurance",
        lambda p: [max(p.numbers("saved state", "record as it is")) / 1e6],
    ),
    Quote(
        "open loop, {:.0f} seeds each of {:,.0f} and {:,.0f} samples",
        "accuracy",
        lambda p: [min(over(p, OPEN, "converged")), *over(p, OPEN, "experiment")],
    ),
    Quote(
        "all converge; RMSE of break points and slope ratio {:.2f} to {:.2f} times the Cramer-Rao bound; 95 % "
        "intervals cover {:.0f} to {:.0f} %",
        "accuracy",
        open_loop,
    ),
    Quote(
        "routine closed loop, {:,.0f} samples, drifting disturbance mild / strong, {:.0f} seeds",
        "accuracy",
        lambda p: [
            p.number("routine closed loop, white noise", "experiment"),
            p.numbers(DAILY[0], "converged")[1],
        ],
    ),
    Quote(
        "median error of the break points {:.1f} % / {:.1f} % of the half-width; intervals cover {:.0f} to {:.0f} %. "
        "Without a noise model: {:.0f} % / {:.0f} %",
        "accuracy",
        daily,
    ),
    Quote("said so in {:.0f} of {:.0f} records", "accuracy", lambda p: pairs(p.numbers("", "says so"))),
    Quote("{:.0f} random loops", "family", lambda p: [p.number("all", "cases")]),
    Quote(
        "said so in {:.1f} %, intervals cover {:.0f} %, delay right in {:.1f} % of the records that tell it; where it "
        "does not, refused or an honest interval in {:.1f} %",
        "family",
        family,
    ),
    Quote(
        "`lm.RecursiveML`, {:.0f} seeds of {:,.0f} samples",
        "online",
        lambda p: [p.numbers("20,000", "converged")[1], p.number("20,000", "samples")],
    ),
    Quote(
        "all converge; RMSE {:.2f} to {:.2f} times the bound; about {:.1f} us a sample, where a step of a "
        "plain recursive least squares in Python takes {:.0f} times as long",
        "online",
        recursive,
    ),
    Quote(
        "mean absolute error {:.1f} % above the loop without dead zone, {:.2f} of the plain inverse's turns beyond the "
        "noise; with a width up to {:.0f} % wrong the block's guard leaves no limit cycle larger than without "
        "compensation",
        "compensation",
        compensated,
    ),
    Quote("executed over {:,.0f} adversarial scans: equal to the simulated block to the last bit", "export", exported),
    Quote(
        "against the paper's recursive estimator, {:,.0f} samples",
        "paper",
        lambda p: p.said("seeds of # samples"),
    ),
    Quote(
        "break-point errors {:.0f} times smaller",
        "paper",
        lambda p: [min(p.said("are # (left) and # (right) times smaller"))],
    ),
    Quote(
        "{:,.0f} samples, one thread | the likelihood refinement takes {:.2f} of the time of a plain "
        "`scipy.optimize.least_squares` fit from a generic start that is told orders and noise; the whole `identify` "
        "with orders and noise given, which searches globally, settles the offset and tests the result, {:.1f} of it, "
        "with orders and noise found from the data {:.1f}",
        "speed",
        speed,
    ),
    Quote(
        "a fault of the actuator named in {:.0f} loops, the right one in {:.0f}; where the record tells the fault it "
        "is named in {:.0f} of {:.0f}; false alarms in {:.0f} of {:.0f} loops without one; real loops right where "
        "told: {:.0f} of {:.0f} of the comparison set of the International Stiction Data Base ({:.0f} left open), "
        "{:.0f} of {:.0f} of its others ({:.0f}), {:.0f} of {:.0f} of SACAC ({:.0f}), {:.0f} of {:.0f} of a refinery "
        "({:.0f})",
        "diagnosis",
        diagnosed,
    ),
    Quote(
        "dead zone {:.1f} .. {:.1f} in OP units, width {:.1f} +/- {:.1f}, preferred to the linear model by {:.0f} "
        "(BIC); simulated from OP alone the model fits {:.0f} % of PV",
        "readme-examples",
        lambda p: [
            p.number(PAP4, "left"),
            p.number(PAP4, "right"),
            *p.numbers(PAP4, "width"),
            p.number(PAP4, "over linear"),
            p.number(PAP4, "fit, %"),
        ],
    ),
    Quote(
        "the right kind in {:.0f} of {:.0f} loops with stiction and {:.0f} of {:.0f} with backlash; the band of the "
        "sticking ones right to a percent in {:.0f} % of them and inside its interval in {:.0f} of {:.0f}, which is "
        "{:.1f} % of it wide",
        "stiction",
        sticking,
    ),
    Quote("What all {:.0f} gave", "shared-data", lambda p: p.said("All # records")),
    Quote(
        "{:.2f} .. {:.2f} V, and",
        "readme-examples",
        lambda p: [p.number(MOTOR, "left"), p.number(MOTOR, "right")],
    ),
    Quote(
        "no lost motion seen; wider than {:.1f} % would have been",
        "readme-examples",
        lambda p: [p.number(POSITIONER, "below, % of span")],
    ),
    Quote(
        "biased by {:.0f} % (mild drift) and {:.0f} % (strong drift) of the half-width where the AR noise model has "
        "{:.1f} % and {:.1f} % (docs/accuracy.md)",
        "accuracy",
        lambda p: [p.number(row, "median error") for row in (*AS_PAPER, *DAILY)],
        "docs/method.md",
    ),
    Quote(
        "a block for {:.0f} of {:.0f} faulty valves; error with it {:.2f} of that without (median; {:.2f} to {:.2f}), "
        "made worse by {:.0f} of them; measured over foretold {:.2f} to {:.2f} in nine of ten",
        "blocks",
        blocks,
    ),
    Quote(
        "{:.0f} of {:.0f} wrong estimates ({:.0f} records) have a larger limit cycle with the block than without",
        "compensation-study-figures",
        wrong_estimates,
        "docs/compensation-study.md",
    ),
    Quote(
        "IAE {:.3f} to {:.3f} of that without dead zone",
        "compensation-study-figures",
        lambda p: span(p.numbers("", "ratio")),
        "docs/compensation-study.md",
    ),
)
EXCERPTS = {"$ lostmotion diagnose FIC-101.csv --loop-type flow --figure fic101.png": "readme-examples"}
GIVEN = {
    "20 to 30 % of the oscillations": "literature, as cited in the paper's introduction",
    "Ulaganathan and Rengaswamy 2008": "literature",
    "ICINCO 2010": "the paper",
    "up to 2 hours back": "a rule of online/timeline.py",
    "Python 3.11": "pyproject.toml",
    "`right_slope` is 1 by convention": "a convention",
    "exit code is 0": "a convention",
    "exit code 1": "a convention",
    "all commands: 0, done": "a convention",
    "1, something needs attention": "a convention",
    "2, wrong usage": "a convention",
    "1 at a closed gate": "a convention",
    "Exit code 1": "a convention",
    "exit with 0": "a convention",
    "IEC 61131-3": "a norm",
    "C99": "a norm",
    "32 bits": "a type",
    "10,000 adversarial scans and compared": "a setting: lostmotion.export.scenarios",
    "95 % intervals": "the level of all intervals",
    "`--tolerance` (1 % of span)": "a setting: lostmotion.diagnose.clean_bill",
    "the first ten of each kind, then the 100th, 1000th ..": "a setting: lostmotion.online.messages",
    "The first 60 rows": "a setting: lostmotion.files.growing",
    "remembers about the last 5,000 samples": "1 / (1 - 0.9998)",
    "1 forgets at detected changes only": "a setting",
    "dead zone of +-1 and white noise of variance 0.03": "the paper's tank",
    "orders 1 to 3, delays to 15": "how the loops are drawn",
    "break points within 3 expected standard errors": "what counts as a success",
    "in 32 and 64 bits": "types",
    "no dead band above 1-2 % of travel": "truth of the record: its source",
    "still at +-2 V, moves at +-4 V": "truth of the record: its source",
    "PAP4": "name of a loop",
}
