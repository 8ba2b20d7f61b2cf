"""What the pages of dropped files show: contexts of their templates, and the same as JSON."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from markupsafe import Markup

from lostmotion.audit.plant_view import FAULTS
from lostmotion.report.plant import LoopPage, LoopView, loop_page
from lostmotion.web.desk.desk import Desk
from lostmotion.web.desk.fields import COLUMN, LOOP_TYPES, NONE, ROLES, SETTING, TITLE, in_fields, way_words
from lostmotion.web.desk.item import Item
from lostmotion.web.trend.slot import Slot
from lostmotion.web.worker.jobs import Job

PHASES = {
    "read": ("reading", "checking", "diagnosing"),
    "study": ("reading", "diagnosing", "simulating"),
    "block": ("writing the block", "replaying the written code"),
}
PATIENCE = 25.0  # s of a job, after which the page says why it may take long
WORDS = {
    "waiting": "waits", "running": "at work", "failed": "not done", "done": "done", "several": "several loops",
    "new": "not begun",
}  # fmt: skip


def files_context(desk: Desk) -> dict[str, Any]:
    """Page on which files are dropped."""
    return {
        "lines": [line(desk, item) for item in desk.items()],
        "most": f"{desk.limits.file_bytes / 1e6:g}",
        "most_bytes": desk.limits.file_bytes,
        "kept": str(desk.records) if desk.kept else "",
        "open": any(desk.state(item) in ("waiting", "running") for item in desk.items()),
    }


def line(desk: Desk, item: Item) -> dict[str, str]:
    """One file or loop in a list."""
    state, brief = desk.state(item), item.brief
    said = WORDS[state]
    if state in ("done", "failed") and brief is not None:
        said = in_fields(str(brief["words"] or brief["verdict"] or said))
    elif state == "several":
        said = f"{len((item.look or {}).get('loops', []))} loops"
    return {"name": item.name, "url": f"/files/{item.id}", "state": state, "word": WORDS[state], "said": said}


def columns_context(item: Item) -> dict[str, Any]:
    """Page of the columns alone."""
    return {"item": item, "form": column_form(item)}


def file_context(desk: Desk, item: Item, trend: Slot | None = None) -> dict[str, Any]:
    """Page of one file or loop, whatever its state."""
    state, job = desk.state(item), desk.jobs.of(item.id)
    result, view = item.result or {}, item.view
    working = job if job is not None and job.open else None
    there = view is not None and (state == "done" or (working is not None and working.kind != "read"))
    error = result.get("error")
    return {
        "item": item,
        "parent": desk.item(item.parent) if item.parent else None,
        "state": state,
        "job": None if working is None else job_words(desk, working),
        "cancelled": job is not None and job.state == "cancelled",
        "section": _loop_page(view, trend) if there and view is not None else None,
        "trend": trend,
        "result": result,
        "error": error,
        "ways": [way_words(way) for way in (error or {}).get("ways", [])],
        "lines": [line(desk, one) for one in desk.loops(item)],
        "form": column_form(item, (error or {}).get("parts", []), result.get("check", {}).get("modes", [])),
        "block": block_context(item, view.row.verdict if view is not None else ""),
    }


def _loop_page(view: LoopView, trend: Slot | None) -> LoopPage:
    """Pieces of the page; where the trend can be zoomed it has PV over OP, too."""
    page = loop_page(view)
    page = replace(page, notes=tuple(map(in_fields, page.notes)), advice=tuple(map(in_fields, page.advice)))
    if trend is None or trend.state != "ready":
        return page
    return replace(page, trend=(), trend_rows=[], plane=Markup(""))


def job_words(desk: Desk, job: Job) -> dict[str, Any]:
    """A job as the page shows it."""
    phases = PHASES[job.kind]
    now = phases.index(job.phase) if job.phase in phases else 0
    ahead = desk.jobs.ahead(job)
    waits = f"waits for {ahead} other job{'s'[: ahead > 1]}" if ahead else "waits for its turn"
    known = job.to_dict()
    long = " (the first time after an installation takes minutes)" if (known["seconds"] or 0.0) > PATIENCE else ""
    return {
        **known,
        "phases": [
            (name, "done" if place < now else "now" if place == now else "next") for place, name in enumerate(phases)
        ],
        "words": waits if job.state == "waiting" else f"{job.phase or 'starting'} ..{long}",
    }


def column_form(item: Item, parts: Sequence[str] = (), modes: Sequence[str] = ()) -> dict[str, Any]:
    """Selects with the columns that there are, what was found, which fields an error names, and the words of modes."""
    look = item.look or {"columns": [], "rows": [], "roles": {}, "more": 0}
    asked, roles = item.asked, look["roles"]
    of_column = {column: role for role, column in roles.items()}
    selects = [_select(role, asked.get(role), roles.get(role), look["columns"]) for role in ROLES]
    span = asked.get("op_span") or ("", "")
    integrating = asked.get("integrating")
    return {
        "selects": selects,
        "columns": [(name, of_column.get(name, "").upper()) for name in look["columns"]],
        "rows": look["rows"],
        "choosable": len(look["columns"]) > 1,
        "more": look["more"],
        "dt": asked.get("dt", ""),
        "low": span[0],
        "high": span[1],
        "automatic": ", ".join(_listed(asked.get("automatic"))),
        "modes": f"found: {', '.join(modes)}" if modes else "AUTO, CAS ..",
        "loop_type": asked.get("loop_type", ""),
        "loop_types": LOOP_TYPES,
        "integrating": "" if integrating is None else "yes" if integrating else "no",
        "named": sorted({found[1] for found in SETTING.finditer(parts[2])}) if len(parts) > 2 else [],
    }


def _listed(value: Any) -> list[str]:
    return [value] if isinstance(value, str) else list(value or ())


def _select(role: str, asked: Any, found: str | None, columns: list[str]) -> dict[str, Any]:
    """One select: value and text of its options, and which one is chosen."""
    usual = f"as found: {found}" if found is not None and asked is None else "find it by its name"
    options = [("", usual)]
    options += [(NONE, "do not read it")] if role not in ("op", "pv") else []
    names = columns if not isinstance(asked, str) or asked in columns else [asked, *columns]
    options += [(COLUMN + name, name) for name in names]
    chosen = NONE if asked is False else COLUMN + asked if isinstance(asked, str) else ""
    return {"role": role, "title": TITLE[role], "options": options, "chosen": chosen}


def block_context(item: Item, verdict: str) -> dict[str, Any]:
    """The way to a block, as far as it went."""
    from lostmotion.export.dialects import TARGETS  # noqa: PLC0415  a second; the page of a plant does without

    study, export = item.study, item.export
    closed = None
    if study is not None and study.get("outcome") == "closed":
        closed = study["steps"][-1]
    return {
        "worth": verdict in FAULTS and verdict != "saturation",
        "study": study,
        "closed": closed,
        "way": way_words(closed["settings"]) if closed is not None and closed["settings"] else "",
        "there": study is not None and study.get("block") is not None,
        "export": export,
        "targets": [(name, dialect.title) for name, dialect in TARGETS.items()],
        "name": block_name(item.stem),
        "today": datetime.now(UTC).date().isoformat(),
    }


def block_name(text: str) -> str:
    """Name of a block that every tool takes.

    Examples
    --------
    >>> block_name("FIC-101 (new)"), block_name("..")
    ('FY_FIC_101_new', 'FY_1')
    """
    from lostmotion.export.names import LONGEST  # noqa: PLC0415

    words = re.findall(r"[A-Za-z0-9]+", text)
    return f"FY_{'_'.join(words) or '1'}"[:LONGEST].rstrip("_")


def as_json(desk: Desk, item: Item) -> dict[str, Any]:
    """State of an item for programs."""
    job, brief = desk.jobs.of(item.id), item.brief or {}
    verdict = brief.get("verdict")
    return {
        "id": item.id,
        "label": item.label,
        "loop": item.loop,
        "came": item.came,
        "url": f"/files/{item.id}",
        "state": desk.state(item),
        "job": None if job is None else {**job.to_dict(), "words": job_words(desk, job)["words"]},
        "looked": item.look is not None,
        "verdict": verdict,
        "said": brief.get("words"),
        "loops": [one.id for one in desk.loops(item)],
        "diagnosis": f"/files/{item.id}/diagnosis.json" if verdict is not None else None,
    }
