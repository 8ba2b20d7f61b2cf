"""Time axes: dates where they are known, else elapsed time in the unit that its length asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HOURS_BETWEEN_TICKS = (0.5, 1.0, 2.0, 4.0, 6.0, 12.0)
MAX_TICKS = 8
DATES = ("%Y", "%b", "%d %b", "%H:%M", "%H:%M", "%H:%M:%S")  # ticks that are years, months .. seconds
ZERO_DATES = ("", "%Y", "%b", "%d %b", "%H:%M", "%H:%M:%S")  # where such a tick begins the next larger unit
OFFSETS = ("", "%Y", "%Y", "%Y-%m-%d", "%Y-%m-%d", "%Y-%m-%d")


class TimeUnit(NamedTuple):
    """Unit of an axis of elapsed time: seconds in it, and the label of the axis."""

    seconds: float
    label: str


SECONDS, MINUTES = TimeUnit(1.0, "time, s"), TimeUnit(60.0, "time, min")
HOURS, DAYS = TimeUnit(3600.0, "time, h:min"), TimeUnit(86_400.0, "time, days")
UNIT_FROM = ((172_800.0, DAYS), (10_000.0, HOURS), (600.0, MINUTES))  # shortest length in s, longest unit first


def unit_of(length: float) -> TimeUnit:
    """Return the unit for an axis that is `length` seconds long.

    Examples
    --------
    >>> [unit_of(length).label for length in (59.0, 1800.0, 14_400.0, 604_800.0)]
    ['time, s', 'time, min', 'time, h:min', 'time, days']
    """
    return next((unit for shortest, unit in UNIT_FROM if length >= shortest), SECONDS)


def set_ticks(axes: Axes, unit: TimeUnit, length: float) -> None:
    """Set round ticks on an axis that is `length` seconds long; hours are written 1:30, not 1.5."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator  # noqa: PLC0415  optional extra

    if unit is not HOURS:
        axes.xaxis.set_major_locator(MaxNLocator(MAX_TICKS, steps=[1, 2, 5, 10]))
        return
    hours = length / HOURS.seconds
    between = next((step for step in HOURS_BETWEEN_TICKS if hours <= MAX_TICKS * step), HOURS_BETWEEN_TICKS[-1])
    axes.xaxis.set_major_locator(MultipleLocator(between))
    axes.xaxis.set_major_formatter(lambda value, _: hours_and_minutes(value))


def hours_and_minutes(hours: float) -> str:
    """Return hours as on a clock.

    Examples
    --------
    >>> hours_and_minutes(1.5), hours_and_minutes(26.0), hours_and_minutes(-0.5)
    ('1:30', '26:00', '-0:30')
    """
    minutes = round(60.0 * abs(hours))
    return f"{'-' if hours < 0.0 else ''}{minutes // 60}:{minutes % 60:02d}"


def set_dates(axes: Axes) -> None:
    """Set dates and times under an axis: days with their month, times as on a clock, the rest once at the end."""
    from matplotlib import dates  # noqa: PLC0415  optional extra

    locator = dates.AutoDateLocator(minticks=4, maxticks=MAX_TICKS)  # type: ignore[no-untyped-call]
    for unit in (dates.MINUTELY, dates.SECONDLY):
        locator.intervald[unit] = [1, 2, 5, 10, 15, 30]  # its own lack the 2
    formatter = dates.ConciseDateFormatter(  # type: ignore[no-untyped-call]
        locator, formats=DATES, zero_formats=ZERO_DATES, offset_formats=OFFSETS
    )
    axes.xaxis.set_major_locator(locator)
    axes.xaxis.set_major_formatter(formatter)
