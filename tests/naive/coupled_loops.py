"""Slow twin of ``kernels.coupled_loops``: loops as objects, from the words of its docstring, all arrays spelled out."""

from __future__ import annotations

import math

NAMES = (
    "kind p0 p1 p2 p3 stroke curve gain lag1 lag2 rate delay sensor filter kp ki scan master ratio op_rest pv_rest "
    "tracks low high"
)


class Loop:
    """One loop at rest."""

    def __init__(self, numbers):
        self.__dict__.update(zip(NAMES.split(), map(float, numbers), strict=True))
        self.z1 = self.z2 = 0.0
        self.stem = self.integral = self.op = self.op_rest
        self.sensed = self.filtered = self.sp = self.seen = self.pv_rest
        self.mode = 1 if self.master < 0 else 2
        self.x, self.flows, self.levels = 0.0, [], []

    def move(self, u):
        """Actuator in deviations: none, backlash (2)."""
        if self.kind == 2:
            self.x = min(max(self.x, u - 0.5 * self.p0), u + 0.5 * self.p0)
            return self.x
        return u


def run(numbers, wires, weights, events, load, noise):
    """OP, PV, SP, position and mode of all rows."""
    loops, lagged, rows = [Loop(one) for one in numbers], [0.0] * len(wires), []
    for k in range(len(load)):
        for row, i, code, value in events:
            if row == k:
                _event(loops[int(i)], code, value)
        for i, one in enumerate(loops):
            one.sensed += one.sensor * (one.pv_rest + one.z2 - one.sensed)
            if not math.isnan(noise[k][i]):
                one.seen = min(max(one.sensed + noise[k][i], -1.25), 103.125)
            one.filtered += one.filter * (one.seen - one.filtered)
        for one in loops:
            _track(one, loops)
        coming = list(load[k])
        for j, (source, target, what, delay) in enumerate(wires):
            past = (loops[source].levels, loops[source].flows)[what]
            value = past[k - delay] if k >= delay else 0.0
            lagged[j] += weights[j][1] * (value - lagged[j])
            coming[target] += weights[j][0] * lagged[j]
        rows.append([_step(one, loops, coming[i], k) for i, one in enumerate(loops)])
        for one in loops:
            one.levels.append(one.z2)
    return rows


def _event(one, code, value):
    if code == 0:
        one.sp = value
    elif code == 1:
        one.mode = int(value)
    elif one.mode == 0:
        one.op = min(max(value, 0.0), 100.0)


def _track(one, loops):
    if one.master >= 0 and one.mode != 2:
        master = loops[int(one.master)]
        there = one.sp if one.mode == 1 else one.filtered
        master.op = min(max(master.op_rest + (there - one.pv_rest) / one.ratio, master.low), master.high)
        master.integral = master.op - master.kp * (master.sp - master.filtered)


def _step(one, loops, load, k):
    if one.mode == 0 and one.tracks:
        one.sp = one.filtered
    if one.mode == 2:
        master = loops[int(one.master)]
        one.sp = min(max(one.pv_rest + one.ratio * (master.op - master.op_rest), 0.0), 100.0)
    error = one.sp - one.filtered
    if one.mode == 0:
        one.integral = one.op - one.kp * error
    elif k % int(one.scan) == 0:
        advanced = one.integral + one.ki * error
        wanted = one.kp * error + advanced
        one.op = min(max(wanted, one.low), one.high)
        if wanted > one.high:
            advanced = min(advanced, one.integral) if error > 0.0 or one.ki < 0.0 else advanced
        if wanted < one.low:
            advanced = max(advanced, one.integral) if error < 0.0 or one.ki < 0.0 else advanced
        one.integral = advanced
    position = min(max(one.op_rest + one.move(one.op - one.op_rest), 0.0), 100.0)
    one.stem += one.stroke * (position - one.stem)
    away = one.stem - one.op_rest
    one.flows.append(away + one.curve * away * away / 100.0)
    flow = one.flows[k - int(one.delay)] if k >= one.delay else 0.0
    one.z1 += one.lag1 * (one.gain * (flow + load) - one.z1)
    if one.rate > 0.0:
        one.z2 = min(max(one.pv_rest + one.z2 + one.rate * one.z1, 0.0), 100.0) - one.pv_rest
    else:
        one.z2 += one.lag2 * (one.z1 - one.z2)
    return one.op, one.seen, one.sp, position, one.mode
