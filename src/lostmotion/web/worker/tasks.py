"""What the worker of a page does with a file: read, check, diagnose; study; write the block. Results are JSON files."""

from __future__ import annotations

import io
import re
import traceback
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError

import lostmotion as lm
from lostmotion.diagnose import Diagnosis
from lostmotion.errors import DataError, LostMotionError, one_line
from lostmotion.evaluate import Solution
from lostmotion.export.dialects import TARGETS
from lostmotion.files.opened import Opened, opened
from lostmotion.files.quality import Trust
from lostmotion.files.results import read_json, write_json
from lostmotion.files.watch import watched
from lostmotion.files.writer import write_bytes
from lostmotion.records import LoopRecord
from lostmotion.records.checked import CheckedRecord
from lostmotion.report.fit_text import UNEARNED, dynamics, finding, parameter_rows, sentence
from lostmotion.report.plant import LoopView
from lostmotion.report.plant.of_diagnosis import diagnosis_view
from lostmotion.report.plant.words import headline
from lostmotion.report.solution_text import outcome
from lostmotion.report.study_text import HEAD, ROWS, case_cells
from lostmotion.web.desk.view_json import plain, view_to_json
from lostmotion.web.kept_record import keep_record, kept_record
from lostmotion.web.worker.looked import looked
from lostmotion.web.worker.task import (
    BLOCK,
    DROPPED,
    EXPORT,
    FIT,
    JUDGING,
    LOOK,
    READING,
    RECORD,
    RESULT,
    STUDY,
    ZIP,
    Task,
    failure,
    keep_result,
)

REPLAYED = 10_000  # scans
COUNTED = re.compile(r"(\d{1,6}) of (\d{1,6})\b")
MOST_MODES = 12  # words that are shown

Tell = Callable[[str, float, str], None]


def do(task: Task, tell: Tell) -> dict[str, Any]:
    """Do a task; an error becomes its result.

    Parameters
    ----------
    task : Task
    tell : callable
        Is given a phase, the share that is done, and what is being done in words.

    Returns
    -------
    dict
        "loops": names of several loops in the file, none of which was chosen; else empty.
    """
    work, name = {"read": (_read, RESULT), "study": (_study, STUDY), "block": (_export, EXPORT)}[task.kind]
    try:
        return work(task, tell)
    except (LostMotionError, LinAlgError) as error:
        _write(task, name, {"error": said(error, task.label)})
    except MemoryError:
        _write(task, name, {"error": failure(TOO_MUCH)})
    except Exception as error:  # noqa: BLE001  a page must say something, whatever a file does
        traceback.print_exc()
        _write(task, name, {"error": failure(f"The worker failed: {one_line(f'{type(error).__name__}: {error}')}")})
    return {}


TOO_MUCH = "It takes more memory than a file may here; cut the export, or set LOSTMOTION_MOST_GIB."


def said(error: Exception, label: str = "") -> dict[str, Any]:
    """Error as the page shows it."""
    parts = getattr(error, "said", None) or ("", "", "")
    ways = [dict(way) for way in getattr(error, "ways", ())]
    text = one_line(str(error)) or type(error).__name__
    shown = [part.replace(DROPPED, label or DROPPED) for part in (text, *parts)]
    return {"text": shown[0], "parts": shown[1:] if parts[0] else [], "ways": plain(ways), "type": type(error).__name__}


def _write(task: Task, name: str, data: Mapping[str, Any], words: str = "") -> None:
    if name == RESULT:
        keep_result(task.place, plain(data), words)
        return
    write_json(task.place / name, plain(data), force=True)


def _read(task: Task, tell: Tell) -> dict[str, Any]:
    tell("reading", 0.02, "")
    asked = task.chosen(READING)
    with watched(lambda line: tell("reading", 0.05, line.replace(DROPPED, task.label))):
        content = _content(task.sources, tuple(_named(asked)), _trust(asked))
        look = looked(content, task.sources, asked)
        _write(task, LOOK, look)
        if look["loops"]:
            return {"loops": look["loops"]}
        record = _record(task, content, asked)
    tell("checking", 0.3, "")
    keep_record(task.place / RECORD, record)
    checked = CheckedRecord.of(record)
    found: dict[str, Any] = {"record": repr(record), "tag": record.tag, "check": _check(checked, record)}
    tell("diagnosing", 0.35, "")
    try:
        diagnosis = lm.diagnose(
            record, **task.chosen(JUDGING), progress=lambda line: tell("diagnosing", share_of(line), line)
        )
    except (LostMotionError, LinAlgError) as error:
        _write(task, RESULT, {**found, "error": said(error, task.label)})
        return {}
    tell("writing", 0.95, "")
    view = diagnosis_view(diagnosis, task.label)
    _write(task, RESULT, found | _diagnosed(diagnosis, view), headline(view.row))
    return {}


def share_of(line: str) -> float:
    """Share of a reading and diagnosis that is done, from the words of the diagnosis.

    Examples
    --------
    >>> share_of("windows"), share_of("7 of 14: day 7 12:00")
    (0.35, 0.65)
    """
    found = COUNTED.match(line)
    return 0.35 if found is None else round(0.35 + 0.6 * min(int(found[1]) / max(int(found[2]), 1), 1.0), 3)


@lru_cache(maxsize=1)
def _content(sources: tuple[str, ...], asked: tuple[str, ...], trust: Trust) -> Opened:
    """What a file holds: opened once for all its loops, which are read one after another."""
    return opened(sources[0] if len(sources) == 1 else list(sources), asked, None, trust)


def _named(asked: Mapping[str, Any]) -> list[str]:
    return [asked[name] for name in ("op", "pv", "sp", "position", "mode") if isinstance(asked.get(name), str)]


def _trust(asked: Mapping[str, Any]) -> Trust:
    return Trust(asked.get("quality") is not False, asked.get("uncertain", "keep") == "keep")


def _record(task: Task, content: Opened, asked: Mapping[str, Any]) -> LoopRecord:
    settings: dict[str, Any] = {name: tuple(one) if isinstance(one, list) else one for name, one in asked.items()}
    record = lm.read_loop(content, **settings)
    tag = task.tag if record.tag in ("", DROPPED) else record.tag
    return replace(record, tag=tag, source=record.source.replace(DROPPED, task.label))


def _check(found: CheckedRecord, record: LoopRecord) -> dict[str, Any]:
    findings = [
        {"level": one.level, "text": " ".join(part for part in (one.what, one.why, one.remedy) if part)}
        for one in found.report.findings
    ]
    share = f"{100.0 * found.share:.3g} % of {len(record)} rows are used."
    return {
        "usable": found.usable,
        "said": found.prepared.refusal or share,
        "findings": findings,
        "modes": [] if record.mode is None else [str(one) for one in np.unique(record.mode)[:MOST_MODES] if one],
        "notes": list(dict.fromkeys((*found.report.notes, *found.prepared.notes))),
    }


def _diagnosed(diagnosis: Diagnosis, view: LoopView) -> dict[str, Any]:
    fit = diagnosis.fit
    return {
        "diagnosis": diagnosis.to_dict(),
        "view": view_to_json(view),
        "summary": diagnosis.summary(),
        "fit": {
            "status": fit.status.name,
            "said": [sentence(fit), finding(fit), dynamics(fit)],
            "parameters": [] if fit.status in UNEARNED else [list(row) for row in parameter_rows(fit)],
            "summary": fit.summary(),
        },
    }


def _study(task: Task, tell: Tell) -> dict[str, Any]:
    tell("reading", 0.02, "")
    record = kept_record(task.place / RECORD)
    given = dict(task.given)
    kp, ki = given.pop("kp", None), given.pop("ki", None)
    controller = None if kp is None or ki is None else lm.PI(kp, ki)
    span = given.pop("span", None)
    shares = {"diagnosing": 0.1, "identifying": 0.4, "simulating": 0.5}
    found = lm.solve(
        record, controller=controller, span=None if span is None else (span[0], span[1]), **given,
        **{name: value for name, value in task.chosen(JUDGING).items() if name != "tolerance"},
        progress=lambda line: tell(line, shares.get(line, 0.1), ""),
    )  # fmt: skip
    if found.block is not None and found.fit is not None:
        _write(task, BLOCK, found.block.to_dict())
        write_json(task.place / FIT, found.fit.to_dict(), force=True)
    _write(task, STUDY, {"asked": dict(task.given), **_solved(found)})
    return {}


def _solved(found: Solution) -> dict[str, Any]:
    study = found.study
    told: dict[str, Any] = {
        "outcome": found.outcome,
        "said": outcome(found),
        "steps": [step.to_dict() for step in found.steps],
        "verdict": None if found.diagnosis is None else found.diagnosis.verdict,
        "block": None if found.block is None else found.block.to_dict(),
        "study": None,
    }
    if study is not None:
        told["study"] = {
            "recommendation": study.recommendation,
            "safe": study.safe,
            "reasons": list(study.reasons),
            "head": list(HEAD),
            "rows": [list(case_cells(ROWS[name], case)) for name, case in study.cases.items()],
            "controller": f"Kp {study.controller.kp:.4g}, Ki {study.controller.ki:.4g} 1/s ({study.controller_source})",
            "described": study.described,
            "summary": study.summary(),
        }
    return told


def _export(task: Task, tell: Tell) -> dict[str, Any]:
    tell("writing the block", 0.1, "")
    given = dict(task.given)
    block, fit = lm.read_block(task.place / BLOCK), lm.read_fit(task.place / FIT)
    scan, verdict = given.pop("scan_time", None), read_json(task.place / STUDY, "a study", "study it again")["verdict"]
    block = block if scan is None else block.changed(scan)
    done = lm.export.export(block, given.pop("to"), fit=fit, diagnosis=verdict, accept=block.accepted or None, **given)
    tell("replaying the written code", 0.3, "")
    proof = done.replay(REPLAYED)
    if not proof.agrees:
        raise DataError.expected("code that does what the block does", proof.summary(), "use another dialect")
    name = done.source.name
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, text in done.files.items():
            archive.writestr(f"{name}/{file}", text)
    write_bytes(task.place / ZIP, stream.getbuffer(), force=True)
    _write(task, EXPORT, {
        "file": f"{name}_{done.target}.zip", "name": name, "to": done.target, "title": TARGETS[done.target].title,
        "files": list(done.files), "replay": proof.summary(), "accepted": block.accepted,
    })  # fmt: skip
    return {}
