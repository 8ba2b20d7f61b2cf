"""Arguments of ``identify``, checked."""

from __future__ import annotations

from lostmotion.arguments import whole
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.likelihood.asked import DEFAULT_ORDERS, Asked


def check_choice(name: str, value: object, allowed: tuple[str | bool | None, ...]) -> None:
    """Refuse what is not among the choices."""
    if value not in allowed:
        raise ParameterError.expected(f"{name} as one of {list(allowed)}", repr(value), "choose one of them")


MOST_ORDER, MOST_DELAY = 20, 10_000  # samples; "auto" tries 3, and no loop is sampled 10,000 times in its dead time


def orders_of(orders: str | tuple[int, int, int]) -> tuple[int, int, int] | None:
    """Orders (na, nb, delay); None where they are chosen from the data."""
    if isinstance(orders, str):
        check_choice("orders", orders, ("auto",))
        return None
    remedy = "whole numbers >= 0, e.g. (3, 2, 3)"
    try:
        na, nb, delay = (whole("orders", value, 0) for value in orders)
    except (TypeError, ValueError) as error:
        raise ParameterError.expected("orders as (na, nb, delay)", repr(orders), remedy) from error
    return na, nb, delay


def integrating_of(integrating: bool | None, orders: str | tuple[int, int, int], gain: float | None) -> bool | None:
    """Whether the process integrates; None where the data decide."""
    check_choice("integrating", integrating, (None, True, False))
    if integrating and gain is not None:
        raise ParameterError.expected("no gain of an integrating process", gain, "leave gain out, or integrating")
    if integrating and orders[0] == 0:
        raise ParameterError.expected("an order na >= 1 of an integrating process", orders, "give the order of its A")
    return integrating if gain is None else False


def noise_lags_of(noise: str | int) -> int | None:
    """Order of the autoregression of the noise; None where it is chosen from the data."""
    if isinstance(noise, str):
        check_choice("noise", noise, ("auto", "ar", "white"))
        return 0 if noise == "white" else None
    if isinstance(noise, bool):
        raise ParameterError.expected('noise as "auto", "ar", "white" or an order', noise, "e.g. noise=4")
    return whole('noise (or "auto", "white")', noise, 0)


def check_length(shortest: int, asked: Asked) -> None:
    """Refuse segments that are too short for the orders, and orders of no process."""
    if shortest < asked.needed:
        na, nb, delay = asked.orders or DEFAULT_ORDERS
        raise DataError.expected(
            f"at least {asked.needed} samples in every segment for orders {(na, nb, delay)}",
            f"{shortest}",
            "use lower orders or longer records",
        )
    if asked.orders is not None and (max(asked.orders[:2]) > MOST_ORDER or asked.orders[2] > MOST_DELAY):
        remedy = "resample the record where the process is slower"
        raise ParameterError.expected(f"orders up to ({MOST_ORDER}, {MOST_ORDER}, {MOST_DELAY})", asked.orders, remedy)
