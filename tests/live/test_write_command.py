"""`lostmotion live --write` and `lostmotion request` as they are typed: both words or nothing, and the whole way."""

import json
import signal

import pytest

pytest.importorskip("asyncua")

from lostmotion.live.audit_log import read_log
from tests.support.command import run
from tests.support.live_bench import PATIENCE, Bench, Command, fit_of

pytestmark = pytest.mark.long

SPEED = 2.0  # a scan is 0.25 s, the time-out 5 s
ARGUMENTS = ("--insecure",)


@pytest.fixture(scope="module")
def bench():
    made = Bench(SPEED)
    yield made
    made.close()


@pytest.fixture(scope="module")
def fit(bench, tmp_path_factory):
    from lostmotion.live.virtual_plant import VirtualPlant

    path = tmp_path_factory.mktemp("fit") / "tic103.json"
    fit_of(VirtualPlant.worn(), bench.server.period, path)
    return path


def test_with_the_word_of_the_file_alone_nothing_is_written(bench, tmp_path):
    plant = bench.files(tmp_path / "bench", report_every=4)
    bench.calls.clear()
    heartbeat = bench.seen("heartbeat")
    live = Command("live", plant, *ARGUMENTS)
    try:
        live.until(lambda one: one["kind"] == "note" and "--write" in one["message"])
        live.until(lambda one: one["kind"] == "report" and one["sample"] >= 16)
    finally:
        code, messages, _ = live.end()
    assert (code, bench.calls) == (0, [])
    assert bench.seen("heartbeat") == heartbeat
    assert not (plant.parent / "requests.jsonl").exists()
    assert not any(one["kind"] in ("request", "block") for one in messages)


@pytest.mark.parametrize("write", [False, None])
def test_with_the_word_of_the_command_alone_it_does_not_begin(bench, tmp_path, capsys, write):
    plant = bench.files(tmp_path / "bench", write=write)
    bench.calls.clear()
    code, _, said = run(capsys, "live", plant, "--write", *ARGUMENTS)
    assert code == 2
    assert "expected write = true in [loop.block] of a loop, got none" in said
    code, _, said = run(capsys, "live", bench.address, "--op", "ns=2;s=A", "--pv", "ns=2;s=B", "--write", *ARGUMENTS)
    assert code == 2
    assert "a plant file beside --write" in said
    code, _, said = run(capsys, "request", plant, "TIC103", plant, "--who", "anna", "--write")
    assert (code, "a loop with write = true" in said) == (2, True)
    assert bench.calls == []
    assert not (plant.parent / "requests.jsonl").exists()


def test_a_request_is_a_study_first(bench, tmp_path, capsys, fit):
    plant = bench.files(tmp_path / "bench")
    bench.calls.clear()
    code, out, _ = run(capsys, "request", plant, "TIC103", fit)
    assert code == 0
    assert "COMPENSATION is worth it" in out
    assert "Would be asked of TY103: factor 0.9, first 4" in out
    code, out, _ = run(capsys, "request", plant, "TIC103", fit, "--json")
    said = json.loads(out)
    assert (said["asked"]["factor"], said["study"]["safe"]) == (900, True)
    code, _, said = run(capsys, "request", plant, "TIC103", fit, "--write")
    assert (code, "expected --who" in said) == (2, True)
    code, _, said = run(capsys, "request", plant, "TIC103", fit, "--who", "anna", "--write")
    assert (code, "at work on this plant" in said) == (1, True)
    odd = tmp_path / "odd.json"
    odd.write_text(fit.read_text().replace('"left": 4', '"left": NaN, "x": 4', 1))
    code, _, said = run(capsys, "request", plant, "TIC103", odd, "--who", "anna", "--write")
    assert code == 1
    assert bench.calls == []
    assert list((plant.parent / "requests").iterdir()) == []


def test_the_whole_way(bench, tmp_path, capsys, fit):
    plant = bench.files(tmp_path / "bench", adaptive=False, least_interval=1.0)
    live = Command("live", plant, "--write", *ARGUMENTS)
    try:
        live.until(lambda one: one.get("event") == "begin")
        code, out, said = run(capsys, "request", plant, "TIC103", fit, "--who", "anna", "--write")
        assert code == 0, (out, said)
        assert [line.split(" by ")[0] for line in out.splitlines()] == ["asked", "request", "verify"]
        assert bench.seen("supervision") == 1.0
        second = Command("live", plant, "--write", *ARGUMENTS)  # two supervisors of one block must not be
        second.process.wait(PATIENCE)
        code, messages, said = second.end()
        assert (code, "another one that works with it" in said) == (1, True)
        bench.press()
        bench.until(lambda: bench.seen("supervision") == 3.0)
        live.until(lambda one: one.get("event") == "accept")
        live.until(lambda one: one["kind"] == "block" and one["block"] == "active")
        code, messages, said = live.end(signal.SIGINT)
        assert (code, len(said.splitlines())) == (0, 1), said
        assert "the block sheds within 5 s" in messages[-1]["message"]
        bench.until(lambda: bench.seen("supervision") == 4.0)
        assert bench.seen("shed_reason") == 2.0
    finally:
        live.end(signal.SIGKILL)
    lines = read_log(plant.parent / "requests.jsonl")
    assert [line["event"] for line in lines] == ["start", "begin", "asked", "request", "verify", "accept", "end"]
    assert lines[3]["who"].startswith("anna (")
    assert lines[3]["old"]["factor"] == 0.0
    assert lines[3]["new"]["factor"] == 900
    assert "compensate" in lines[3]["study"]
    told = [one["event"] for one in messages if one["kind"] == "request"]
    assert told == [line["event"] for line in lines]
