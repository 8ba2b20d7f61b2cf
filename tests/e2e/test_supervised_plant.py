"""Supervisor, block and plant together: from a study to a calmer loop, and a campaign of everything that breaks."""

import datetime as dt
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import GateError
from lostmotion.live.audit_log import AuditLog, read_log
from lostmotion.live.link import LinkError
from lostmotion.live.supervisor import Supervisor
from lostmotion.live.virtual_plant import VirtualPlant
from lostmotion.live.virtual_plc import VirtualPlc
from tests.properties.test_supervised import quiet
from tests.support.supervised_laws import violations

SCANS = 1_500


class BadLink:
    """The link of a PLC that loses, delays and halves what is written, and sometimes does not answer."""

    def __init__(self, plc, random, share):
        self.plc, self.random, self.share = plc, random, share
        self.late = []

    def read(self, names):
        if self.random.random() < 0.3 * self.share:
            raise LinkError("expected an answer, got none; in a test")
        return self.plc.read(names)

    def write(self, values):
        if self.random.random() >= self.share:
            self.plc.write(values)
            return
        match self.random.integers(4):
            case 0:  # lost
                pass
            case 1:  # there, but nobody knows
                self.plc.write(values)
            case 2:  # half of it
                self.plc.write(dict(list(values.items())[: len(values) // 2]))
            case _:  # some scans later
                self.late.append([int(self.random.integers(1, 30)), dict(values)])
        raise LinkError("expected an answer, got none; in a test")

    def scan(self):
        """What was under way arrives."""
        for item in self.late:
            item[0] -= 1
        for _, values in [item for item in self.late if item[0] <= 0]:
            self.plc.write(values)
        self.late = [item for item in self.late if item[0] > 0]


def campaign(seed, folder, share=0.05):
    """Random faults of link, supervisor, PLC, operator and clocks; inputs, cold starts and outputs of every scan."""
    random = np.random.default_rng(seed)
    one = quiet("backlash")
    plc = VirtualPlc(one.block)
    clock, wall = [0.0], [dt.datetime(2026, 1, 1, tzinfo=dt.UTC)]
    log = AuditLog(folder / f"{seed}.jsonl", lambda: wall[0])
    link = BadLink(plc, random, share)

    def begin():
        options = {"write": True, "least_interval": 1.0, "answer_within": 1.0, "clock": lambda: clock[0]}
        return Supervisor(one.block, link, log, name="FY-101", **options)

    supervisor, frozen, rows, cold, outputs = begin(), 0, [], [], []
    for name in ("enable", "auto_mode", "cascade", "good"):
        plc.set(name, 1.0)
    for k in range(SCANS):
        clock[0] += 0.1
        wall[0] += dt.timedelta(days=float(random.normal(scale=30.0))) if random.random() < 0.01 else dt.timedelta(0)
        started = k == 0 or random.random() < 0.002
        if started:
            plc.restart()
        if random.random() < 0.005:
            supervisor = begin()
        frozen = int(random.integers(1, 25)) if random.random() < 0.005 else max(frozen - 1, 0)
        for name, usual in (("good", 1.0), ("track", 0.0), ("auto_mode", 1.0), ("cascade", 1.0)):
            plc.set(name, 1.0 - usual if random.random() < 0.002 else usual)
        plc.set("accept", float(random.random() < 0.2))
        link.scan()
        op = 50.0 + 10.0 * np.sin(k / 30.0)
        plc.set("track_value", op)  # else the way back from manual may be longer than the cap
        plc.scan(op)
        rows.append(plc.inputs[0].copy())
        outputs.append(plc.outputs[0].copy())
        cold.append(started)
        if frozen:
            continue
        try:
            supervisor.cycle()
            if random.random() < 0.1:
                widths = {"lead_up": 0.7 + 0.2 * random.random(), "factor": float(random.choice((0.5, 0.8)))}
                tried = one.block.block.with_settings(**widths)
                study = SimpleNamespace(safe=True, recommendation="compensate", block=tried, described="a test")
                supervisor.propose(study, "anna")
        except (LinkError, GateError):
            pass
    accepted = sum(line["event"] == "accept" for line in read_log(log.path))
    return one, np.array(rows), np.array(cold), np.array(outputs), accepted


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(2))
def test_a_campaign_of_faults_breaks_no_law(seed, tmp_path):
    one, inputs, cold, outputs, accepted = campaign(seed, tmp_path)
    broken = {law: count for law, count in violations(one, inputs, cold, outputs).items() if count}
    assert broken == {}
    assert accepted > 2
    names = [variable.name for variable in one.specification.section("output")]
    reasons = set(outputs[:, names.index("SHED_REASON")])
    assert len(reasons) > 4


@pytest.mark.statistics
def test_from_a_study_to_a_calmer_loop(tmp_path):
    plant, plain = VirtualPlant.worn(), VirtualPlant.worn()
    loop = plant.loops["FIC-102"]
    part = 1.0 - np.exp(-0.5 / 4.0)
    model = lm.Hammerstein(lm.Backlash(2.0), lm.LinearModel([part - 1.0], [1.2 * part], 1, 0.5))
    small = {"runs": 2, "samples": 800, "draws": 1, "cycle_samples": 1500}
    study = lm.compensation_study(
        model, lm.PI(0.5, 0.12), noise=0.05**2, op_now=45.0, block=loop.block.block, sp_step=4.0, **small
    )
    assert study.safe
    supervisor = Supervisor(
        loop.block, loop.plc, AuditLog(tmp_path / "log"), name="FY-102", write=True, clock=lambda: loop.time
    )
    errors = []
    for k in range(3_000):
        plant.step()
        plain.step()
        supervisor.cycle()
        if k == 5:
            supervisor.propose(study, "anna")
        if k == 20:
            loop.accept()
        errors.append([abs(each.loops["FIC-102"].pv - loop.sp) for each in (plant, plain)])
    assert supervisor.state == "accepted"
    with_block, without = np.mean(errors[1_000:], axis=0)
    assert with_block < 0.8 * without
    assert plant.values()["FIC-102.MODE"] == 1.0
