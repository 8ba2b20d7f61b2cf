"""`lostmotion live --write` under the faults of the issue, as a command, in order: each ends passive, none comes back.

One plant, one process that writes, a proxy between them; the wall clock of the log jumps at each line.
"""

import math
import signal
import time

import pytest

pytest.importorskip("asyncua")

from asyncua import ua

from lostmotion.compensate.request import Request
from lostmotion.live.audit_log import read_log
from tests.support.command import run
from tests.support.live_bench import Bench, Command, Proxy, fit_of

pytestmark = pytest.mark.long

SPEED = 2.0  # a scan is 0.25 s, the time-out 5 s, and another request may come 5 s after an accept
PASSIVE, REQUESTED, ACTIVE, SHED = 0.0, 1.0, 3.0, 4.0
KEY = 3  # of the block TY103
JUMPING = """
import datetime, itertools, sys
from lostmotion.live import audit_log
jumps = itertools.cycle((0, -400, 9000, -3, 40000))
real = audit_log._now
audit_log.AuditLog.__init__.__defaults__ = (lambda: real() + datetime.timedelta(days=next(jumps)),)
from lostmotion.cli import main
main(sys.argv[1:])
"""


class Site:
    """Plant, line, plant file, fit, and the command that writes."""

    def __init__(self, folder):
        from lostmotion.live.virtual_plant import VirtualPlant

        self.bench = Bench(SPEED)
        self.proxy = Proxy(int(self.bench.address.rpartition(":")[2]))
        address = f"opc.tcp://127.0.0.1:{self.proxy.port}"
        self.plant = self.bench.files(folder / "bench", address, adaptive=False, least_interval=1.0)
        self.fit = folder / "fit.json"
        fit_of(VirtualPlant.worn(), self.bench.server.period, self.fit)
        self.start()

    def start(self):
        self.live = Command(self.plant, "--write", "--insecure", run=("-c", JUMPING, "live"))
        self.live.until(lambda one: one.get("event") == "begin")

    def request(self, capsys):
        return run(capsys, "request", self.plant, "TIC103", self.fit, "--who", "anna", "--write")

    def ready(self):
        """A process that writes, and nothing in force: workers steal tests, so any other may have run before."""
        if self.live.process.poll() is not None:
            self.start()
        if self.bench.seen("supervision") == ACTIVE:
            self.bench.plant.loops["TIC-103"].plc.restart()
        self.bench.until(lambda: self.bench.seen("link_ok") == 1.0)
        time.sleep(20 * self.bench.server.period + 0.5)  # since the last accept

    def armed(self, capsys):
        """A request that was asked, shown, and accepted by the operator."""
        self.ready()
        before = self.bench.seen("echo_id")
        code, out, said = self.request(capsys)
        assert code == 0, (out, said, read_log(self.log)[-4:])
        assert self.bench.seen("echo_id") > before
        self.bench.press()
        self.bench.until(lambda: self.bench.seen("supervision") == ACTIVE)
        return self.bench.seen("force_id")

    @property
    def log(self):
        return self.plant.parent / "requests.jsonl"

    def stays(self, state, seconds=3.0):
        """Nothing comes back by itself, and nobody asks again, whatever the operator presses."""
        ids = len(self.bench.ids_written())
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.bench.press()
            assert self.bench.seen("supervision") == state
            time.sleep(0.2)
        assert len(self.bench.ids_written()) == ids

    def shed(self, reason, within=None):
        begun = time.monotonic()
        self.bench.until(lambda: self.bench.seen("supervision") == SHED)
        assert self.bench.seen("shed_reason") == reason
        if within is not None:
            assert time.monotonic() - begun < within

    def close(self):
        self.live.end(signal.SIGKILL)
        self.proxy.close()
        self.bench.close()


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    made = Site(tmp_path_factory.mktemp("site"))
    yield made
    made.close()


def timeout(site):
    """Seconds to the shed, with room for a busy machine."""
    return 20 * site.bench.server.period + 5.0


def test_a_frozen_heartbeat(site, capsys):
    site.armed(capsys)
    site.live.send(signal.SIGSTOP)
    site.shed(2.0, timeout(site))
    site.live.send(signal.SIGCONT)
    site.bench.until(lambda: site.bench.seen("link_ok") == 1.0)
    site.stays(SHED)


def test_a_request_of_another_hand_changes_nothing_that_was_accepted(site, capsys):
    force = site.armed(capsys)
    in_force = [site.bench.seen(name) for name in ("force_factor", "force_first", "force_second")]
    again = Request(int(force), 300, 48_500, 51_500, KEY)
    site.bench.write(**again.values)  # a duplicate id
    site.bench.write(request_id=int(force) - 1)  # and an old one
    site.bench.until(lambda: site.bench.seen("refusal") == 1.0)
    wrong = Request(int(force) + 1, 300, 48_500, 51_500, KEY)
    site.bench.write(**{**wrong.values, "checksum": wrong.checksum + 1})
    site.bench.until(lambda: site.bench.seen("refusal") == 2.0)
    site.bench.press()
    time.sleep(1.0)
    assert site.bench.seen("supervision") == ACTIVE
    assert [site.bench.seen(name) for name in ("force_factor", "force_first", "force_second")] == in_force
    assert site.bench.seen("force_id") == force


def test_what_another_hand_asks_rightly_is_withdrawn(site, capsys):
    site.armed(capsys)
    right = Request(int(site.bench.seen("echo_id")) + 1, 300, 48_500, 51_500, KEY)
    time.sleep(20 * site.bench.server.period)
    site.bench.write(**right.values)
    site.live.until(lambda one: one.get("event") == "withdraw")
    site.bench.until(lambda: site.bench.seen("waiting") == 0.0)
    assert site.bench.seen("force_id") < right.id


def test_a_request_that_is_changed_while_it_is_shown(site, capsys):
    site.ready()
    code, out, said = site.request(capsys)
    assert code == 0, (out, said)
    site.bench.write(asked_first=48_900)
    site.live.until(lambda one: one.get("event") in ("refusal", "withdraw"))
    site.bench.press()
    time.sleep(1.0)
    assert site.bench.seen("waiting") == 0.0
    assert site.bench.seen("force_id") == 0.0


def test_a_line_that_is_half_open(site, capsys):
    site.armed(capsys)
    site.proxy.hold()
    site.shed(2.0, timeout(site))
    site.live.until(lambda one: one["kind"] == "lost" and "nothing is sent again" in one["message"])
    site.proxy.let_go()  # what was held arrives now
    site.bench.until(lambda: site.bench.seen("link_ok") == 1.0)
    site.stays(SHED)


def test_a_late_write_is_withdrawn(site, capsys):
    site.ready()
    site.proxy.keep, kept = True, site.proxy.kept
    code, out, _ = site.request(capsys)
    assert (code, out.splitlines()[-1].split(" by ")[0]) == (1, "failed")
    assert site.proxy.kept == kept + 1
    assert site.bench.seen("waiting") == 0.0
    site.proxy.deliver()
    site.live.until(lambda one: one.get("event") == "withdraw")
    site.bench.until(lambda: site.bench.seen("waiting") == 0.0)
    assert site.bench.seen("supervision") in (PASSIVE, SHED)
    site.stays(site.bench.seen("supervision"))


def test_no_number_where_one_is_due(site, capsys):
    site.armed(capsys)
    node = site.bench.server._nodes["TY103.FORCE_FIRST"].nodeid
    data = ua.DataValue(ua.Variant(math.nan, ua.VariantType.Double))
    stop = time.monotonic() + 40.0
    while site.bench.seen("supervision") == ACTIVE and time.monotonic() < stop:
        site.bench.do(site.bench.server._server.write_attribute_value(node, data))
        time.sleep(0.1)
    site.shed(2.0)
    site.live.until(lambda one: one["kind"] == "lost" and "force_first" in one["message"])
    site.bench.until(lambda: site.bench.seen("link_ok") == 1.0)  # force_first has changed, and is a number again
    site.stays(SHED)


def test_a_client_that_is_killed_and_begins_anew(site, capsys):
    site.armed(capsys)
    site.live.end(signal.SIGKILL)
    site.shed(2.0, timeout(site))
    left = site.plant.parent / "requests" / "TIC103.request"
    left.write_text("{}")
    site.start()
    assert not left.exists()
    site.bench.until(lambda: site.bench.seen("link_ok") == 1.0)
    site.stays(SHED)
    site.armed(capsys)


def test_a_plc_that_begins_anew(site, capsys):
    site.armed(capsys)
    site.bench.plant.loops["TIC-103"].plc.restart()
    site.bench.until(lambda: site.bench.seen("supervision") == PASSIVE)
    site.bench.until(lambda: site.bench.seen("link_ok") == 1.0)
    site.stays(PASSIVE)


def test_a_stop_is_told_and_sheds(site, capsys):
    site.armed(capsys)
    code, messages, said = site.live.end(signal.SIGTERM)
    assert (code, len(said.splitlines())) == (0, 1), said
    assert messages[-1]["event"] == "end"
    site.shed(2.0, timeout(site))
    lines = read_log(site.log)
    accepted = {line["id"] for line in lines if line["event"] == "accept"}
    asked = {line["new"]["id"] for line in lines if line["event"] == "verify"}
    assert accepted <= asked  # nothing was in force that was not asked, shown and accepted
    assert all(line["who"] for line in lines)
    ids = [call for call in site.bench.ids_written() if call]
    assert all(len(call) == 1 or call[-1] == "TY103.REQUEST_ID" for call in ids)
