"""From the estimate in service to a calmer loop: wish, study, request, accept, on the bench's loop with a dead zone.

Simulated time; the same parts as `live --write`, without its threads and its network.
"""

import json
import logging

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import GateError
from lostmotion.live.audit_log import AuditLog, read_log
from lostmotion.live.supervision.settings import BlockSettings
from lostmotion.live.supervision.studies import block_with_widths_of, study_of_estimate, study_of_fit
from lostmotion.live.supervision.wanted import wish
from lostmotion.live.supervisor import READ, Supervisor
from lostmotion.live.virtual_plant import VirtualPlant

LEARNED, LATER = 2_000, 4_000


def settings_of(loop, **more):
    study = {"sp_step": loop.swing, "hold": loop.swing_seconds}
    return BlockSettings(
        "TIC103", "TY103", loop.block, {}, lm.PI(loop.kp, loop.ki), True, True, study=study, **more
    )  # fmt: skip


def scanned(loop, scans, supervisor=None):
    """Command, PV and error of so many scans."""
    rows = []
    for _ in range(scans):
        loop.scan()
        if supervisor is not None:
            supervisor.cycle()
        rows.append((loop.command, loop.values()["pv"], loop.set_point - loop.pv))
    return np.array(rows).T


@pytest.mark.statistics
def test_the_loop_gets_calmer(tmp_path):
    loop, plain = (VirtualPlant.worn().loops["TIC-103"] for _ in range(2))
    settings = settings_of(loop)
    log = AuditLog(tmp_path / "log")
    supervisor = Supervisor(loop.block, loop.plc, log, name="TY103", write=True, clock=lambda: loop.time)
    estimator = lm.RecursiveML(1, 0, 1, noise=6, start_samples=600, dt=loop.scan_time)
    op, pv, _ = scanned(loop, LEARNED, supervisor)
    estimator.run(op, pv, every=LEARNED)
    estimate = estimator.estimate
    assert estimate.status.name == "OK"
    assert abs(estimate.parameters["width"] - 4.0) < 0.2
    found = wish(settings, estimate, loop.plc.read(READ))
    study = study_of_estimate(settings, estimate, found.tried)
    assert (study.safe, study.recommendation) == (True, "compensate")
    assert {case.group for case in study.mistakes} == {"2 standard errors", "20 %", "drawn"}
    assert "an estimate in service" in study.model_source
    request = supervisor.propose(study, "the estimate")
    scanned(loop, 5, supervisor)
    loop.accept()
    op, pv, errors = scanned(loop, LATER, supervisor)
    scanned(plain, LEARNED + 5)
    without = scanned(plain, LATER)[2]
    assert supervisor.state == "accepted"
    assert loop.plc.read(["force_first"])["force_first"] == pytest.approx(0.001 * request.first)
    assert [line["event"] for line in read_log(log.path)] == ["begin", "request", "verify", "accept"]
    ratio = float(np.mean(np.abs(errors)) / np.mean(np.abs(without)))
    logging.getLogger(__name__).info("%.3f -> %.3f", np.mean(np.abs(without)), np.mean(np.abs(errors)))
    assert ratio < 0.85
    estimator.run(op, pv, every=LATER)  # what goes to the valve has jumped over the gap: it is as wide as before
    assert abs(estimator.estimate.parameters["width"] - 4.0) < 0.2


def test_a_bad_estimate_passes_no_study():
    loop = VirtualPlant.worn().loops["TIC-103"]
    op, pv, _ = scanned(loop, 300)
    estimator = lm.RecursiveML(1, 0, 1, noise=6, start_samples=600, dt=loop.scan_time)
    estimator.run(op, pv, every=300)
    with pytest.raises(GateError, match="an estimate in service of status OK"):
        study_of_estimate(settings_of(loop), estimator.estimate, loop.block.block)


@pytest.mark.statistics
def test_widths_of_a_fit():
    loop = VirtualPlant.worn().loops["TIC-103"]
    op, pv, _ = scanned(loop, 2_500)
    fit = lm.identify(op, pv, loop.scan_time, nonlinearity="dead zone", orders=(1, 0, 1))
    settings = settings_of(loop)
    study = study_of_fit(settings, json.loads(json.dumps(fit.facts.to_dict())))
    assert study.safe
    tried, commissioned = study.block.settings, loop.block.block.settings
    free = {"left_break", "right_break", "factor"}
    assert {name for name in tried if tried[name] != commissioned[name]} <= free
    assert abs(tried["left_break"] - 48.0) < 0.3
    assert tried["factor"] <= commissioned["factor"]
    other = VirtualPlant.worn().loops["FIC-102"]
    with pytest.raises(GateError, match="a fit of a backlash"):
        block_with_widths_of(settings_of(other), fit.facts)
