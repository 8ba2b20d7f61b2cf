"""``lostmotion online`` as it runs beside a plant: growing files, pipes, signals, kills and restarts."""

import json
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli import main
from lostmotion.files.writer import lock_file

pytestmark = pytest.mark.statistics

OPTIONS = (
    "--orders", "1,0,1", "--noise", "white", "--start-samples", "300", "--report-every", "200",
    "--trend-every", "400", "--forgetting", "0.9995",
)  # fmt: skip
ROWS = 6000


def run(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        main(["online", *map(str, words)])
    seen = capsys.readouterr()
    return int(stop.value.code or 0), [json.loads(line) for line in seen.out.splitlines()], seen.err


def record(n=ROWS, right=1.0, width=None):
    """Lines of a CSV with decimal commas, a few gaps, bad cells and repeated rows."""
    rng = np.random.default_rng(1)
    u = lm.signals.prs(n, -5, 5, hold=8, seed=1)
    edges = np.full(n, right) if width is None else width
    x = np.where(u > edges, u - edges, np.where(u < -1, u + 1, 0.0))
    y = lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + 0.05 * rng.normal(size=n)
    moments = np.datetime64("2024-03-01T06:00:00") + np.arange(n) * np.timedelta64(2, "s")
    lines = ["Zeit;OP;PV;Mode"]
    for k in range(n):
        pv = "Bad" if k % 997 == 500 else f"{y[k]:.4f}"
        lines.append(f"{moments[k]};{u[k]:.4f};{pv};{'MAN' if k % 800 > 790 else 'AUT'}".replace(".", ","))
    del lines[3000:3010]
    lines[4000:4000] = [lines[3999]]
    return [f"{line}\r\n" for line in lines]


@pytest.fixture(scope="module")
def lines():
    return record()


def columns():
    return ("--time", "Zeit", "--mode", "Mode")


@pytest.fixture(scope="module")
def expected(lines, tmp_path_factory):
    """Messages of one uninterrupted run."""
    path = tmp_path_factory.mktemp("whole") / "FIC-1.csv"
    path.write_text("".join(lines))
    done = subprocess.run(command(path, "--no-follow"), capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return told(done.stdout)


def command(source, *words):
    return [sys.executable, "-m", "lostmotion", "online", str(source), *OPTIONS, *columns(), *map(str, words)]


def told(*outputs):
    """Reports, events and notes, each once, in order; what comes again must be the same."""
    found = {}
    for output in outputs:
        for line in output.splitlines():
            message = json.loads(line)
            if message["kind"] == "start":
                continue
            key = (message["kind"], message.get("sample"), message.get("line"), message.get("name"))
            assert found.setdefault(key, message) == message
    return list(found.values())


def wait_for(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "nothing happened in time"
        time.sleep(0.02)


def test_one_run(expected):
    reports = [message for message in expected if message["kind"] == "report"]
    assert [report["sample"] for report in reports] == list(range(200, ROWS + 1, 200))
    last = reports[-1]
    assert last["status"] == "OK"
    assert abs(last["width"]["value"] - 2.0) < 4 * last["width"]["standard_error"]
    assert last["time"] == "2024-03-01T09:19:58"
    assert last["counts"]["missing"] == 10 + 6
    assert last["counts"]["manual"] == 9 * 7
    assert [message["message"] for message in expected if message["kind"] == "note"] == [
        "Line 4001 (2024-03-01T08:13:36): its time is not a sample later than that of the row before; left out."
    ]
    assert not [message for message in expected if message["kind"] == "event"]


@pytest.mark.long
def test_a_file_that_grows_and_sigterm(tmp_path, lines, expected):
    path, state = tmp_path / "FIC-1.csv", tmp_path / "state"
    whole = "".join(lines).encode()
    path.write_bytes(whole[:10])
    out = (tmp_path / "out").open("wb+")

    def write():
        with path.open("ab", buffering=0) as stream:
            for start in range(10, len(whole), 7001):
                stream.write(whole[start : start + 7001])
                time.sleep(0.02)

    writer = threading.Thread(target=write)
    with out, subprocess.Popen(command(path, "--state", state, "--follow"), stdout=out, stderr=subprocess.PIPE) as run:
        writer.start()
        last = expected[-1]["sample"]
        wait_for(lambda: f'"sample": {last}'.encode() in (tmp_path / "out").read_bytes())
        writer.join()
        run.send_signal(signal.SIGTERM)
        assert run.wait(20) == 0
        assert run.stderr.read() == b""
    assert told((tmp_path / "out").read_text()) == expected
    with path.open("a") as stream:
        stream.write("2024-03-01T09:20:00;1,0;1,0;AUT\r\n" * 2)
    done = subprocess.run(command(path, "--state", state, "--no-follow"), capture_output=True, text=True, check=False)
    start, *others = [json.loads(line) for line in done.stdout.splitlines()]
    assert start["message"] == f"Goes on after sample {ROWS}."
    assert {message["kind"] for message in others} <= {"note", "report"}


@pytest.mark.long
@pytest.mark.parametrize("moment", [1, 17])
def test_kill_and_going_on_is_one_run(tmp_path, lines, expected, moment):
    path, state, first = tmp_path / "FIC-1.csv", tmp_path / "state", tmp_path / "out"
    path.write_text("".join(lines[: 200 * moment + 350])[:-3])  # ends within a line
    with first.open("wb") as out, subprocess.Popen(command(path, "--state", state), stdout=out) as run:
        wait_for(lambda: first.read_bytes().count(b'"report"') >= moment)
        with path.open("a") as stream:
            stream.write("".join(lines[: 200 * moment + 350])[-3:] + "".join(lines[200 * moment + 350 : -1000]))
        wait_for(lambda: first.read_bytes().count(b'"report"') >= moment + 1)
        run.kill()
    path.write_text("".join(lines))
    done = subprocess.run(command(path, "--state", state, "--no-follow"), capture_output=True, text=True, check=False)
    output = first.read_text()
    assert told(output[: output.rfind("\n") + 1], done.stdout) == expected


@pytest.mark.long
@pytest.mark.parametrize("again", ["from the beginning", "where it stopped"])
def test_standard_input(tmp_path, lines, expected, again):
    state = tmp_path / "state"
    half = len(lines) // 2
    first = subprocess.run(
        command("-", "--state", state), input="".join(lines[:half]).encode(), capture_output=True, check=False
    )
    rest = lines if again == "from the beginning" else lines[half:]
    second = subprocess.run(
        command("-", "--state", state), input="".join(rest).encode(), capture_output=True, check=False
    )
    assert first.stderr == second.stderr == b""
    found = told(first.stdout.decode(), second.stdout.decode())
    reports = [message for message in expected if message["kind"] == "report"]
    assert [message for message in found if message["kind"] == "report"] == reports


def test_interrupt_while_standard_input_is_silent(tmp_path, lines):
    state = tmp_path / "state"
    pipe = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command("-", "--state", state), **pipe) as run:
        run.stdin.write("".join(lines[:1000]).encode())
        run.stdin.flush()
        wait_for(lambda: state.exists() and state.stat().st_size > 1000)
        run.send_signal(signal.SIGINT)
        assert run.wait(20) == 0
        assert b"Traceback" not in run.stderr.read()


def write(path, lines):
    path.write_text("".join(lines))
    return path


def test_findings_exit_with_1(capsys, tmp_path):
    n = np.arange(ROWS)
    path = write(tmp_path / "a.csv", record(right=1.0, width=np.where(n < 3000, 1.0, 2.0)))
    code, messages, _ = run(capsys, path, *OPTIONS, *columns(), "--no-follow", "--width-limit", 2.5)
    names = {message["name"] for message in messages if message["kind"] == "event"}
    assert code == 1
    assert names >= {"right", "width limit"}
    assert messages[-1]["trend"] is not None


def test_a_quiet_run_exits_with_0_and_needs_no_state(capsys, tmp_path, lines):
    code, messages, error = run(capsys, write(tmp_path / "a.csv", lines), *OPTIONS, *columns(), "--no-follow")
    assert (code, error) == (0, "")
    assert messages[0]["kind"] == "start"
    assert messages[0]["dt"] == 2.0
    assert "decimal comma" in messages[0]["message"]


def test_a_record_that_does_not_tell_exits_with_1(capsys, tmp_path, lines):
    code, messages, _ = run(capsys, write(tmp_path / "a.csv", lines[:250]), *OPTIONS, *columns(), "--no-follow")
    assert code == 1
    assert (messages[-1]["status"], messages[-1]["sample"]) == ("STARTING", 249)


def test_rows_after_the_last_report_are_told_at_the_end_unless_a_state_keeps_them(capsys, tmp_path, lines):
    path = write(tmp_path / "a.csv", lines[:451])
    words = (path, *OPTIONS, *columns(), "--no-follow", "--report-every", 400, "--trend-every", 400)
    code, messages, _ = run(capsys, *words, "--width-limit", 1.0)
    events = [message["sample"] for message in messages if message.get("name") == "width limit"]
    reported = [message["sample"] for message in messages if message["kind"] == "report"]
    assert (code, reported, events) == (1, [400, 450], [400])
    late = ("--report-every", 1000, "--trend-every", 1000, "--width-limit", 1.0)
    code, messages, _ = run(capsys, *words, *late)
    assert code == 1
    assert [(message["kind"], message["sample"]) for message in messages[1:]] == [("report", 450), ("event", 450)]
    code, messages, _ = run(capsys, *words, *late, "--state", tmp_path / "state")
    assert code == 1
    assert [message["kind"] for message in messages] == ["start"]


def test_orders_from_a_fit(capsys, tmp_path):
    loop = lm.routine_operation(3000, drift="none", seed=3)
    fit = lm.identify(
        loop.command, loop.measured, 0.1, orders=(3, 2, 3), noise="white", gain=2.2222, nonlinearity="dead zone"
    )
    (tmp_path / "fit.json").write_text(json.dumps(fit.to_dict()))
    table = {"t_s": loop.time, "OP": loop.command, "PV": loop.measured}
    path = lm.files.write_columns(tmp_path / "a.csv", table)
    code, messages, _ = run(capsys, path, "--fit", tmp_path / "fit.json", "--no-follow")
    assert code == 0
    assert abs(messages[-1]["width"]["value"] - 2.0) < 0.1
    assert messages[-1]["left"]["standard_error"] < 0.05
    other = lm.files.write_columns(tmp_path / "b.csv", table | {"t_s": loop.time * 10})
    with pytest.raises(SystemExit):
        main(["online", str(other), "--fit", str(tmp_path / "fit.json"), "--no-follow"])
    assert "a fit at dt = 1 s" in capsys.readouterr().err


def test_another_file_or_other_options_are_refused(capsys, tmp_path, lines):
    path, state = write(tmp_path / "a.csv", lines[:2000]), tmp_path / "state"
    words = (path, *OPTIONS, *columns(), "--no-follow", "--state", state)
    assert run(capsys, *words)[0] == 0
    kept = state.read_bytes()
    code, messages, error = run(capsys, *words, "--gain", 1.0)
    assert (code, messages) == (2, [])
    assert error.startswith("error: expected gain = 1.0, got None")
    write(path, lines[:1000])
    code, messages, error = run(capsys, *words, "--json")
    assert code == 1
    assert messages[-1]["error"] == "DataError"
    assert "only longer" in error
    assert state.read_bytes() == kept
    state.write_bytes(kept[:-1])
    assert "damaged" in run(capsys, *words)[2]


def test_two_services_do_not_share_a_state(capsys, tmp_path, lines):
    path, state = write(tmp_path / "a.csv", lines[:400]), tmp_path / "state"
    holder = lock_file(state)
    try:
        code, _, error = run(capsys, path, *OPTIONS, *columns(), "--no-follow", "--state", state)
        assert (code, "another one that works with it" in error) == (1, True)
    finally:
        holder.close()
    code, _, error = run(capsys, path, *OPTIONS, *columns(), "--no-follow", "--state", state)
    assert error == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nothing.csv", "--orders", "1,0,1"), "no such file"),
        (("nothing.csv",), "--orders or --fit"),
        (("a.csv", "--orders", "1,0,1", "--op-limits", "9", "1", "--no-follow"), "OP limits"),
        (("a.csv", "--orders", "1,0,1", "--state", "a.csv/state"), "expected a folder"),
        (("a.csv", "--orders", "1,0,1", "--width-limit", "-1"), "width_limit"),
        (("a.csv", "--orders", "1,0,1", "--op", "OPP"), "did you mean"),
    ],
)
def test_bad_input_is_one_clear_line(capsys, tmp_path, monkeypatch, lines, words, said):
    monkeypatch.chdir(tmp_path)
    write(Path("a.csv"), [line.replace("Zeit", "Time") for line in lines[:400]])
    code, messages, error = run(capsys, *words)
    assert code == (1 if said in ("expected a folder", "did you mean") else 2)
    assert messages == []
    assert error.startswith("error: expected")
    assert said in error
    assert error.count("\n") == 1


def test_usage_and_help(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["online"])
    assert stop.value.code == 2
    capsys.readouterr()
    with pytest.raises(SystemExit):
        main(["online", "--help"])
    assert "Example: lostmotion online" in " ".join(capsys.readouterr().out.split())
