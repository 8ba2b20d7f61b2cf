"""Files beside records that others may have written, and what reads them: a plant, its loops, a store, a monitor,
what the link of a plant believes, a form with a dropped file, a supervised block."""

import json
import sqlite3
import tempfile
from contextlib import closing
from datetime import UTC, datetime, timedelta
from functools import cache
from pathlib import Path

import numpy as np

from lostmotion.compensate import CompensatorBlock
from lostmotion.errors import DataError, LostMotionError
from tests.support.hostile_files import changed

TOML = b"""# a plant
address = "opc.tcp://plc1:4840"
[security]
user_file = "plc1.user"
pki = "pki"
[defaults]
dt = 1.0
orders = [3, 2, 3]
op_limits = [0, 100]
[[loop]]
tag = "FIC101"
op = "ns=2;s=FIC101.OP"
pv = "ns=2;s=FIC101.PV"
width_limit = 3.0
[[loop]]
tag = "FIC102"
op = "ns=2;s=FIC102.OP"
pv = "ns=2;s=FIC102.PV"
mode = "ns=2;s=FIC102.MODE"
automatic = ["AUTO"]
frozen = 40
"""
LOOPS = b"""# loops of a plant
tag,op,pv,sp,mode,type,op_span,pv_span,unit,area,service,weight,file,notes
FIC101,FIC101.OP,FIC101.PV,,,flow,0..100,0..40,m3/h,north,feed,2,a.csv,
FIC102,FIC102.OP,FIC102.PV,FIC102.SP,FIC102.MODE,level,,,,"south, old",,1,b.csv,"a ""note"" x"
"""
MODEL = b"""gain = 1.5
time-constant = [30.0, 4]
dead-time = 4
dt = 1
"""
USER = b'user = "ada"\npassword = "not this one"\n'
LIST = b'["plc1", "10.0.0.7"]'
FORM = (
    b'--XX\r\nContent-Disposition: form-data; name="file"; filename="FIC-101.csv"\r\nContent-Type: text/csv\r\n\r\n'
    b"time,OP,PV\r\n0,1,2\r\n1,2,3\r\n\r\n--XX\r\n"
    b'Content-Disposition: form-data; name="file"; filename="FIC-102.csv"\r\n\r\nOP,PV\r\n1,2\r\n\r\n--XX--\r\n'
)
SINCE = [b"2026-03-01", b"2026-03-01 06:00", b"2026-03-01T06:00:00+02:00", b"20260301T060000Z", b"2026-W09-7"]


def lines_of_monitor():
    """As `online` writes them."""
    said = [{"kind": "start", "source": "a.csv", "op": "OP", "pv": "PV", "dt": 2.0, "sample": 0, "message": "dt = 2 s"}]
    for k in range(1, 6):
        value = {"value": 2.0 + 0.1 * k, "standard_error": 0.1, "low": 1.8, "high": 2.9}
        names = ("width", "left", "right", "slope_ratio")
        time = f"2026-03-01T06:0{k}:00"
        said.append(
            {"kind": "report", "sample": 100 * k, "time": time, "status": "FITTED", **dict.fromkeys(names, value)}
        )
    said.append({"kind": "event", "sample": 350, "name": "width", "time": 700.0, "message": "the width has changed"})
    said.append({"kind": "note", "line": 12, "message": "a cell is no number"})
    return "\n".join(map(json.dumps, said)).encode() + b"\n"


@cache
def store_file():
    """A store of SQLite with a run of three loops."""
    from lostmotion.store.rows import AssessmentRow, Stage
    from lostmotion.store.run_rows import LoopRow, ReviewState, RunRow, RunState
    from lostmotion.store.store import Screened, Store

    begin = datetime(2026, 3, 1, tzinfo=UTC)
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "plant.db"
        tags = ("FIC-1", "LIC-2", "TIC-3")
        with Store(path) as store:
            run, _ = store.begin(RunRow("plant"))
            store.put_loops(run, [LoopRow(tag, area="north") for tag in tags])
            rows = [AssessmentRow(tag, begin, begin + timedelta(hours=1), fingerprint="f", stamp="1", value=0.5,
                                  stage=Stage.ASSESSED, health=("stale",), evidence=(("shape", 0.1, -2.5),))
                    for tag in tags]  # fmt: skip
            store.put_screened(run, [Screened((row,)) for row in rows])
            store.put_assessed(run, rows)
            store.review("FIC-1", next(iter(ReviewState)), "ada")
            store.finish(run, RunState.FINISHED)
        with closing(sqlite3.connect(path)) as plain:
            plain.execute("PRAGMA journal_mode=DELETE")
        return path.read_bytes()


@cache
def state_file():
    """A state of `online`, which the page shows too."""
    import lostmotion as lm
    from lostmotion.files.grid import Rows
    from lostmotion.online import OnlineMonitor
    from lostmotion.online.packing import STATE, pack

    monitor = OnlineMonitor(lm.RecursiveML(1, 0, 1, dt=2.0, start_samples=300), dt=2.0, report_every=50, trend_every=50)
    u = lm.signals.prs(400, -5, 5, hold=8, seed=1)
    monitor.take(Rows(2.0 * np.arange(400.0), u, np.roll(u, 1) * 0.5))
    return pack(STATE, {"settings": {}, "position": {}}, monitor.to_bytes())


@cache
def supervised():
    """Every kind of a supervised block."""
    from lostmotion.compensate.supervised import SUPERVISED, SupervisedBlock
    from tests.support.exports import COMMON, KINDS

    blocks = [SupervisedBlock.of(CompensatorBlock.of(kind, 0.1, {**COMMON, **KINDS[kind]})) for kind in SUPERVISED]
    return [json.dumps(block.to_dict()).encode() for block in blocks]


@cache
def certificates():
    """A certificate of a server, as DER and PEM."""
    from cryptography.hazmat.primitives.serialization import Encoding

    from tests.opcua.certificates import pair

    with tempfile.TemporaryDirectory() as place:
        made = pair(Path(place)).certificate
    return [made.public_bytes(form) for form in (Encoding.DER, Encoding.PEM)]


def read_plant(path):
    from lostmotion.live.plant_file import read_plant_file

    return read_plant_file(path).loops


def read_loops(path):
    from lostmotion.plant.loop_list import SHOWN, loop_list_text, read_loop_list

    try:
        return loop_list_text(read_loop_list(path).loops)
    except DataError as error:  # a line for each of the first mistakes
        said = str(error).split("\n")
        assert len(said) <= SHOWN + 1
        assert all(line.startswith(("expected ", "and ")) and len(line) < 3000 for line in said), said
        raise DataError(said[0]) from error


def read_store(path):
    """All that a page asks, and a start of another audit."""
    from lostmotion.store.run_rows import RunRow
    from lostmotion.store.store import Store

    for suffix in ("-wal", "-shm", "-journal"):
        path.with_name(path.name + suffix).unlink(missing_ok=True)
    with Store(path, write=False) as store:
        for run in store.runs():
            store.counts(run.number), store.areas(run.number), store.rows(run.number), store.groups(run.number)
            store.leading(run.number), store.judged(run.number), store.spectra(run.number)
            store.lines(run.number), store.unread(run.number), store.news(run.number)
        store.states(), store.loops(), store.history("FIC-1"), store.reviews("FIC-1")
    with Store(path) as store:
        run, _ = store.begin(RunRow("plant"), resume=False)
        store.finish(run)
    return True


def read_monitor(path):
    """What the page and its JSON say of it; a trouble is said there."""
    from lostmotion.web.monitors.monitor import Watched
    from lostmotion.web.monitors.svg import width_chart

    watched = Watched(str(path))
    watched.look()
    found = watched.look()
    for said in found:
        json.dumps(said.to_dict(), allow_nan=False, ensure_ascii=False).encode()
        words = [said.status, said.words("start", "source"), said.words("start", "dt"), said.words("report", "sample")]
        shown = [str(width_chart(said.points)), *map(str, said.numbers()), *words]
        for which in ("events", "notes"):
            shown += [word for pair in said.said_before(which) for word in pair]
        "".join(shown).encode()
        assert "\n" not in said.trouble
    return not any(said.trouble for said in found)


def read_model(path):
    from lostmotion.cli.rough_model import _read

    return _read(path)


def read_user(path):
    from lostmotion.live.opcua.secrets import user_from

    path.chmod(0o600)
    return user_from(path)


def read_certificates(path):
    """As a server shows it, and as files of a folder of trust."""
    from lostmotion.live.opcua import certificates as own
    from lostmotion.live.opcua.checks import check_server
    from lostmotion.live.opcua.trust import TrustStore

    store = TrustStore(path.parent / "pki")
    for kind, name in (("authorities", "a.der"), ("crl", "a.crl"), ("trusted", "b.json")):
        place = store.folder / kind
        place.mkdir(parents=True, exist_ok=True)
        (place / name).unlink(missing_ok=True)
    sound = own.read_certificate(_kept(path.parent, certificates()[0]))
    found = own.read_certificate(path)
    own.uris(found), own.hosts(found), own.fingerprint(found)
    refused = 0
    for kind, name, shown in (("", "", found), ("authorities", "a.der", sound), ("trusted", "b.json", found)):
        if kind:
            (store.folder / kind / name).write_bytes(path.read_bytes())
        try:
            check_server(shown, "urn:plc", "opc.tcp://plc1:4840", store)
        except LostMotionError as error:
            refused += _in_one_line(error)
        if kind:
            (store.folder / kind / name).unlink()
    return refused < 4


def _in_one_line(error):
    assert "\n" not in str(error)
    return True


def _kept(folder, data):
    path = folder / "sound.der"
    path.write_bytes(data)
    return path


def read_hosts(path):
    from lostmotion.live.opcua.trust import _accepted

    return _accepted(path)


def read_form(path):
    """A form as it comes in pieces."""
    from python_multipart.exceptions import MultipartParseError
    from starlette.exceptions import HTTPException

    from lostmotion.web.desk.item import clean_label
    from lostmotion.web.desk.upload import Form

    class Draft:
        def write(self, data):
            assert isinstance(data, bytes)

        def close(self):
            """Nothing."""

        drop = close

    class Desk:
        limits = type("Limits", (), {"file_bytes": 1 << 20})

        def draft(self):
            return 1, Draft()

        def dropped(self, number, draft, label):
            shown = clean_label(label)
            assert shown.encode()
            assert not set(shown) & set("/\n\0")
            return shown

    form = Form(Desk(), b"XX")
    raw = path.read_bytes()
    try:
        for begin in range(0, len(raw), 37):
            form.take(raw[begin : begin + 37])
        return form.items()
    except (MultipartParseError, HTTPException) as error:  # the page answers 400
        raise LostMotionError(str(error).split("\n", maxsplit=1)[0]) from error
    finally:
        form.close()


def read_supervised(path):
    from lostmotion.compensate.supervised import SupervisedBlock
    from lostmotion.files.results import read_json

    return SupervisedBlock.from_dict(read_json(path, "a supervised block", "save it anew")).to_dict()


def read_since(path):
    from lostmotion.plant.reading import checked_range
    from lostmotion.records.when import as_moment

    moment = as_moment(path.read_bytes().decode("utf-8", "replace"))
    checked_range(moment.replace(tzinfo=UTC), None)
    return str(moment)


USES = {
    "plant.toml": (lambda: [TOML], read_plant), "loops.csv": (lambda: [LOOPS, LOOPS.replace(b",", b";")], read_loops),
    "store": (lambda: [store_file()], read_store), "JSON lines": (lambda: [lines_of_monitor()], read_monitor),
    "state on the page": (lambda: [state_file()], read_monitor), "rough model": (lambda: [MODEL], read_model),
    "user file": (lambda: [USER], read_user), "certificate": (certificates, read_certificates),
    "list of hosts": (lambda: [LIST], read_hosts), "dropped file": (lambda: [FORM], read_form),
    "supervised block": (supervised, read_supervised), "--since": (lambda: SINCE, read_since),
}  # fmt: skip
PLANT = tuple(USES)
NUMBERS = (
    b"1e999",
    b"-1e400",
    b"9" * 400,
    b"9" * 5000,
    b"NaN",
    b"Infinity",
    b"-0",
    b"1e-400",
    b"0x10",
    b"true",
    b"[1]",
)
TEXTS = (
    b'"\\ud800"', b'"\\u0000"', b'"' + b"x" * 200_000 + b'"', b'""', b"null", b"{}", b'"a\\nb"', b"[" * 3000,
    b'{"a":' * 3000,
)  # fmt: skip


def plant_bases(kind):
    return USES[kind][0]()


def plant_mutant(kind, number, seed=0):
    """Like those of records; of texts, every other with a value that no such file has."""
    random = np.random.default_rng([seed, number, *kind.encode()])
    bases = plant_bases(kind)
    base = bases[random.integers(len(bases))]
    if kind not in ("store", "certificate", "state on the page", "dropped file") and random.random() < 0.5:
        return _value(base, random)
    return changed(base, random)


def _value(raw, random):
    """Another value between two marks."""
    marks = [place for place, byte in enumerate(raw) if byte in b' =:,[]{}\n"']
    if len(marks) < 2:
        return raw
    first, last = sorted(random.choice(len(marks), 2, replace=False)) if random.random() < 0.1 else (0, 0)
    if first == last:
        first = int(random.integers(len(marks) - 1))
        last = first + 1
    new = (NUMBERS + TEXTS)[random.integers(len(NUMBERS) + len(TEXTS))]
    return raw[: marks[first] + 1] + new + raw[marks[last] :]
