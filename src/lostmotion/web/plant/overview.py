"""A run as the plant page shows it: a narrow table of its loops in memory, and what is counted from it, once."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from math import inf

import polars as pl
from markupsafe import Markup

from lostmotion.audit.audit_run import as_loop
from lostmotion.audit.health import Health, health_of_rows
from lostmotion.audit.plant_view import RunFacts
from lostmotion.audit.rules import RULES
from lostmotion.audit.run_view import run_facts
from lostmotion.report.plant.pages import NARROW, NEW
from lostmotion.report.plant.svg.treemap import MOST_LOOPS, arranged, drawn
from lostmotion.report.plant.words import LETTER
from lostmotion.store.changed import ORDER, New
from lostmotion.store.overview import OF_LOOP, OF_ROW
from lostmotion.store.queries import Line
from lostmotion.store.rows import DENIED, FINDINGS, GroupRow, Stage
from lostmotion.store.run_rows import ReviewState, RunRow, UnreadRow
from lostmotion.store.said import damaged
from lostmotion.store.store import Store
from lostmotion.web.plant.query import NO_AREA, NO_LABEL, SORTS, Query

TEXTS = frozenset(("verdict", "rule", "label", "split", "stage"))
SURE = {rule.name: rule.sure for rule in RULES.values() if rule.sure is not None}
TYPES = {name: pl.String if name in TEXTS else pl.Float64 for name in OF_ROW}


@dataclass(frozen=True)
class Shown:
    """One page of the ranking.

    Attributes
    ----------
    total : int
        Loops that the query leaves.
    first : int
        Place of the first line among them, from 1.
    lines : tuple of Line
    """

    total: int
    first: int
    lines: tuple[Line, ...]


class Overview:
    """One run.

    Parameters
    ----------
    store : Store
    run : RunRow
    """

    def __init__(self, store: Store, run: RunRow) -> None:
        self.store, self.run = store, run
        self._lock, self._complete = threading.Lock(), False

    @cached_property
    def frame(self) -> pl.DataFrame:
        """One line a loop, in the order of the ranking; made when the table is first asked for."""
        rows, loops = self.store.leading(self.run.number)
        try:
            made = pl.DataFrame(rows, schema={"loop_id": pl.Int64, "window_start": None, **TYPES})
            named = pl.DataFrame(loops, schema={"loop_id": pl.Int64, **dict.fromkeys(OF_LOOP, pl.String)})
            return _ranked(made.join(named, on="loop_id", how="left"))
        except (TypeError, ValueError, OverflowError, pl.exceptions.PolarsError) as error:  # values of another type
            raise damaged(self.store.name) from error

    @cached_property
    def before(self) -> RunRow | None:
        """The finished run before."""
        return self.store.last_run(self.run.number)

    @cached_property
    def facts(self) -> RunFacts:
        """What is said of the run."""
        return run_facts(self.run, self.before, self.store.name)

    @cached_property
    def unread(self) -> list[UnreadRow]:
        """What of the source gave no loop."""
        return self.store.unread(self.run.number)

    @cached_property
    def health(self) -> Health:
        """What could be judged."""
        rows = self.store.judged(self.run.number)
        return health_of_rows(rows, set(self.frame["tag"].to_list()), self.unread)

    @cached_property
    def groups(self) -> tuple[GroupRow, ...]:
        """Loops that swing together."""
        return self.store.groups(self.run.number)

    @cached_property
    def news(self) -> list[New]:
        """What is new since the run before: what was found first, in each the most urgent first."""
        if self.before is None:
            return []
        found = self.store.news(self.run.number, self.before.number)
        place = dict(self.frame.select("tag", "rank").iter_rows())
        return sorted(found, key=lambda one: (ORDER.index(one.what), place.get(one.tag, len(place))))

    @cached_property
    def new_tags(self) -> frozenset[str]:
        """Loops with a new or a worse finding."""
        return frozenset(one.tag for one in self.news if one.what in NEW)

    def words(self, column: str) -> dict[str, int]:
        """How many loops have which word, the most frequent first."""
        found = self.frame[column].value_counts(sort=True)
        return {str(word): int(count) for word, count in found.iter_rows()}

    @cached_property
    def counts(self) -> tuple[tuple[str, str, tuple[tuple[str, int, str], ...]], ...]:
        """Title, name in the address; word, count and letter of each, the most frequent first."""
        kinds = (("Verdict", "verdict", "said"), ("NE 107", "label", "label"), ("Cause in", "split", "split"))
        return tuple((title, name, _counts(self.words(column), name)) for title, name, column in kinds)

    @cached_property
    def choices(self) -> dict[str, list[str]]:
        """What can be chosen in each filter."""
        areas, types = sorted(self.words("area")), sorted(one for one in self.words("type") if one)
        return {
            "area": [one or NO_AREA for one in areas],
            "type": types,
            **{name: [one[0] for one in found] for _, name, found in self.counts},
            "review": [str(state) for state in ReviewState],
        }

    @cached_property
    def treemaps(self) -> tuple[Markup, Markup]:
        """For a screen, and for a telephone."""
        query = Query(run=self.run.number)
        own = self.frame.filter(pl.col("priority") > 0.0).head(MOST_LOOPS)
        rest = self.frame.join(own.select("loop_id"), on="loop_id", how="anti").group_by("area", "label").len()
        weight = self.frame.group_by("area").agg((pl.col("priority").fill_null(0.0) + 0.01).sum())
        lines = self.at(own)
        areas = arranged(
            [line.row for line in lines],
            {line.loop.tag: as_loop(line.loop) for line in lines},
            {(area, label): count for area, label, count in rest.sort("area", "label").iter_rows()},
            dict(weight.sort("area").iter_rows()),
            query.loop,
            lambda area, label: query.link(area=area or NO_AREA, label=label or NO_LABEL),
        )
        return drawn(areas, len(self.frame)), drawn(areas, len(self.frame), *NARROW)

    def complete(self) -> Overview:
        """Itself, with everything that is made once; who comes second waits for the first, and does it not again."""
        with self._lock:
            if not self._complete:
                for name in ("choices", "treemaps", "new_tags", "health", "groups"):
                    getattr(self, name)
                self._complete = True
        return self

    def shown(self, query: Query, brief: bool = False) -> Shown:
        """Page of the ranking that is asked for; one beyond the last is the last. `brief`: rows without evidence."""
        found = self.chosen(query)
        last = max((len(found) - 1) // query.per, 0)
        first = min(query.page - 1, last) * query.per
        return Shown(len(found), first + 1, self.at(found.slice(first, query.per), brief))

    def chosen(self, query: Query) -> pl.DataFrame:
        """Lines that a query leaves, in its order."""
        found = self.frame.filter(*self._conditions(query))
        column, falling = SORTS[query.sort]
        if column == "rank" and not query.turned:
            return found
        return found.sort(column, descending=falling != query.turned, nulls_last=True, maintain_order=True)

    def at(self, lines: pl.DataFrame, brief: bool = False) -> tuple[Line, ...]:
        """Whole rows of some lines, or without their evidence."""
        found = lines.select("loop_id", "window_start")
        keys = [(number, _moment(start)) for number, start in found.iter_rows()]
        return self.store.at(self.run.number, keys, brief)

    def _conditions(self, query: Query) -> list[pl.Expr]:
        asked = {"area": query.area, "type": query.type, "said": query.verdict, "label": query.label,
                 "split": query.split}  # fmt: skip
        found = [
            pl.col(name) == ("" if wanted in (NO_AREA, NO_LABEL) else wanted)
            for name, wanted in asked.items()
            if wanted
        ]
        if query.text:
            found.append(pl.col("search").str.contains(query.text.casefold(), literal=True))
        if query.new:
            found.append(pl.col("tag").is_in(list(self.new_tags)))
        if query.review:
            found.append(self._reviewed(query.review))
        return found

    def _reviewed(self, state: str) -> pl.Expr:
        states = self.store.states()
        if state == ReviewState.NEW:
            return ~pl.col("loop_id").is_in([number for number, one in states.items() if one != state])
        return pl.col("loop_id").is_in([number for number, one in states.items() if one == state])


def _moment(start: str | datetime) -> datetime:
    """SQLite has texts without a zone."""
    moment = datetime.fromisoformat(start) if isinstance(start, str) else start
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def _ranked(frame: pl.DataFrame) -> pl.DataFrame:
    """In the order of the report, as :func:`lostmotion.audit.row_facts.order` has it."""
    assessed, failed = pl.col("stage") == Stage.ASSESSED, pl.col("stage") == Stage.FAILED
    ruled = pl.col("rule") != ""
    said = pl.when(ruled).then("rule").when(assessed).then("verdict").when(failed).then(pl.lit("failed"))
    sure = pl.col("rule").replace_strict(SURE, default=None, return_dtype=pl.Float64).fill_null(pl.col("confidence"))
    frame = frame.with_columns(said.otherwise(pl.lit("not assessed")).alias("said"), sure.alias("sure"))
    kind = pl.when(pl.col("said").is_in(FINDINGS)).then(0).when(pl.col("said").is_in(DENIED)).then(2).otherwise(1)
    added = frame.with_columns(
        (kind + 3 * failed.cast(pl.Int32)).alias("place"),
        pl.col("priority").fill_null(-1.0).alias("urgent"), pl.col("size_percent").fill_null(0.0).alias("sized"),
        pl.col("probability").fill_null(0.0).alias("likely"), pl.col("excluded_percent").fill_null(inf).alias("left"),
    )  # fmt: skip
    keys = ("urgent", "place", "sized", "likely", "left")
    ordered = added.sort(*keys, "tag", descending=[True, False, True, True, True, False])
    return ordered.drop(keys).with_row_index("rank")


def _counts(words: Mapping[str, int], name: str) -> tuple[tuple[str, int, str], ...]:
    if name != "label":
        return tuple((word, count, "") for word, count in words.items())
    return tuple((word or NO_LABEL, count, LETTER.get(word, "")) for word, count in words.items())
