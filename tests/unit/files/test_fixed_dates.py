"""Dates that differ in their digits only are read as any others: the short way and the long one agree."""

from datetime import datetime

import numpy as np
import polars as pl
import pytest

from lostmotion.files import date_parts
from lostmotion.files.fixed_cells import fixed_cells
from lostmotion.files.text import parse_text
from lostmotion.files.text_frame import TextFrame

FORMS = [
    "%Y-%m-%d %H:%M:%S",
    "%Y-%m-%dT%H:%M:%S%.3f",
    "%Y-%m-%dT%H:%M:%S%.9fZ",
    "%d/%m/%Y %H:%M",
    "%m/%d/%y %H:%M:%S",
    "%d.%m.%Y %H:%M:%S,123",
    "%Y-%m-%d %H:%M:%S+01:00",
    "%Y-%m-%d %H:%M:%S-0530",
    "%Y-%m-%d, %H:%M:%S UTC",
    "%Y-%m-%d",
    "%H:%M:%S",
    "15-Nov-%y %H:%M:%S",
    "%d-Abc-%y %H:%M:%S",
    "%d/%m/%Y %I:%M:%S PM",
    "%d/%m/%Y %I:%M:%S a.m.",
]


@pytest.mark.parametrize("form", FORMS)
def test_both_ways_agree(form):
    moments = pl.datetime_range(datetime(2024, 2, 27, 22), datetime(2024, 3, 2), "7s", eager=True)
    cells = moments.dt.strftime(form.replace(".m.", "m"))
    short = fixed_cells(cells, date_parts.DATE)
    assert short is not None
    one, other = date_parts._of_alike(short), date_parts._of_any(cells)
    assert one.month_named == other.month_named
    for name in ("dated", "timed", "seconds"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("numbers", "digits"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize(
    "cells",
    [
        ["21-Jan-17 15:20:00", "21-Feb-17 15:20:00"],
        ["1.2.2024 10:00", "10.2.2024 10:00"],
        ["2024-02-01 10:00", None],
        ["2024-02-01 10:00", "2024-02-01 10.00"],
        ["2024-02-01 10:00", "2024-02-01 1o:00"],
        ["2024-02-01 10:00", "2024-02-01 1:000"],
        ["2024-02-01 10:00Z", "2024-02-01 10:0°"],
        ["soon, 12", "soon, 13"],
        [],
    ],
)
def test_cells_that_differ_otherwise_go_the_long_way(cells):
    assert fixed_cells(pl.Series(cells, dtype=pl.String), date_parts.DATE) is None


def test_days_of_many_cells_are_those_of_few(monkeypatch):
    cells = pl.date_range(datetime(1999, 1, 1), datetime(2009, 1, 1), "1d", eager=True).dt.strftime("%d/%m/%Y")
    whole = date_parts.parts_of(cells)
    monkeypatch.setattr(date_parts, "MANY", 100)
    parts = date_parts.parts_of(cells)
    for order in date_parts.ORDERS:
        np.testing.assert_array_equal(parts.days(order), whole.days(order))


def test_columns_that_were_let_go_are_read_again():
    lines = ["t,OP,PV", *(f"{k},{k % 7},{k % 5}" for k in range(900_000))]
    table = parse_text("\n".join(lines).encode(), "a.csv").taken(np.arange(899_990, 900_000))
    assert isinstance(table.frame, TextFrame)
    before = table.column("OP").to_list()
    table.let_go(["OP", "no such column"])
    assert "OP" not in table.frame._parsed
    assert table.column("OP").to_list() == before
