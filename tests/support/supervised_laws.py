"""What a supervised block must keep to, scan by scan, worked out from its inputs and outputs alone."""

from itertools import pairwise

import numpy as np

from lostmotion.compensate.request import Request
from lostmotion.export.scenarios import scenario
from lostmotion.export.supervised_scans import CALM, Script

LARGEST = 4_000_000
ODD = (np.nan, np.inf, -np.inf, 1e30)


def random_supervision(one, rows, seed):
    """Inputs (rows, n) with one set of settings: every fault of the supervision, now and then each of the loop."""
    random = np.random.default_rng(seed)
    names = [variable.name for variable in one.specification.section("input")]
    columns = {name: k for k, name in enumerate(names)}
    stretches = scenario(one.specification, one.parameters, 64, tame=True)
    inputs = np.repeat(stretches[0].inputs[:1], rows, axis=0)
    walk = 50.0 + 20.0 * np.sin(np.arange(rows) / 37.0) + np.cumsum(random.normal(scale=0.2, size=rows)) % 15.0
    inputs[:, columns["OP_IN"]] = walk
    odd = random.random(rows) < 0.002
    inputs[odd, columns["OP_IN"]] = random.choice(ODD, int(odd.sum()))
    inputs[:, columns["TRACK_VALUE"]] = walk
    for name, usual in CALM.items():
        away = np.zeros(rows, dtype=bool)
        for start in np.flatnonzero(random.random(rows) < 0.002):
            away[start : start + int(random.integers(1, 20))] = True
        inputs[:, columns[name]] = np.where(away, 1.0 - usual, usual)
    script = Script(random, columns, tame=False)
    settings = {key: float(value) for key, value in one.values.items()}
    own = (one.specification.first, one.specification.second)
    frozen = np.zeros(rows, dtype=bool)
    for start in np.flatnonzero(random.random(rows) < 0.01):
        frozen[start : start + int(random.integers(1, 40))] = True
    for k in range(rows):
        script.row(inputs[k], settings, own, bool(frozen[k]))
    cold = random.random(rows) < 0.001
    cold[0] = True
    return inputs.astype(one.dtype), cold


def played(one, inputs, cold):
    """Outputs of the kernel; cold starts where `cold`."""
    parts = []
    bounds = [*np.flatnonzero(cold).tolist(), len(inputs)]
    for start, stop in pairwise(bounds):
        outputs = one.specification.outputs(stop - start, one.dtype)
        one.specification.run(one.parameters, one.specification.state(one.dtype), inputs[start:stop], outputs)
        parts.append(outputs)
    return np.concatenate(parts).astype(np.float64)


def violations(one, inputs, cold, outputs):
    """Number of scans that break each law, by its name."""
    i = {v.name: inputs[:, k].astype(np.float64) for k, v in enumerate(one.specification.section("input"))}
    o = {v.name: outputs[:, k] for k, v in enumerate(one.specification.section("output"))}
    p = one.values
    active = o["SUPERVISION"] == 3.0
    silent = scans_since(beats(i["HEARTBEAT"], cold), cold)
    calm = np.isfinite(i["OP_IN"]) & (i["GOOD"] != 0) & (i["TRACK"] == 0) & (i["AUTO_MODE"] != 0) & (i["CASCADE"] != 0)
    usual = ~cold & np.roll(~cold, 1) & (i["TRACK"] == 0) & np.isfinite(i["OP_IN"])
    usual &= np.roll((i["TRACK"] == 0) & np.isfinite(i["OP_IN"]), 1)
    step = np.abs(np.diff(o["OFFSET"], prepend=0.0))
    free = ~active & calm & (o["STATE"] == 1.0)
    settled = run_length(free & (o["FORCE_ID"] == 0)) > p["cap"] / p["ramp_step"] + 2
    return {
        "active after the time-out": int((active & (silent >= p["timeout"])).sum()),
        "active in a bad state": int((active & ~calm).sum()),
        "active in a first scan": int((active & cold).sum()),
        "compensates while not active": int(((o["STATE"] == 2.0) & ~active).sum()),
        "offset left when passive": int((settled & (o["OFFSET"] != 0.0)).sum()),
        "step beyond the ramp": int((usual & (step > p["ramp_step"] * (1 + 1e-6) + 1e-6)).sum()),
        "output beyond the limits": int((~((o["OP_OUT"] >= p["low"]) & (o["OP_OUT"] <= p["high"]))).sum()),
        "not finite": int((~np.isfinite(outputs)).any(axis=1).sum()),
        **accepts(one, i, o, cold),
    }


def accepts(one, i, o, cold):
    """What came into force: each time by an edge, after it was shown, as it was asked, within the limits."""
    p, wrong = one.values, {"in force without an accept": 0, "in force but not as asked": 0, "changed in force": 0}
    wrong |= {"checksum wrong": 0, "beyond the range": 0, "accepted unseen": 0, "id used twice": 0}
    edge = (i["ACCEPT"] != 0) & (np.roll(i["ACCEPT"], 1) == 0) & ~cold
    force = np.column_stack([o[f"FORCE_{name}"] for name in ("FACTOR", "FIRST", "SECOND")])
    change = np.diff(o["FORCE_ID"], prepend=0.0) != 0.0
    same = ~change & ~cold & (o["FORCE_ID"] != 0)
    wrong["changed in force"] += int((same & (np.diff(force, axis=0, prepend=force[:1]) != 0).any(axis=1)).sum())
    last, epochs, epoch = 0.0, np.cumsum(cold), 0
    for k in np.flatnonzero((change | cold) & (o["FORCE_ID"] != 0)):
        asked = [i[name][k] for name in ("REQUEST_ID", "ASKED_FACTOR", "ASKED_FIRST", "ASKED_SECOND")]
        last, epoch = (last if epochs[k] == epoch else 0.0), epochs[k]
        wrong["in force without an accept"] += int(not edge[k])
        wrong["id used twice"] += int(o["FORCE_ID"][k] <= last)
        last = o["FORCE_ID"][k]
        shown = int(p["show_scans"])
        wrong["accepted unseen"] += int(not (o["WAITING"][max(k - shown, 0) : k] != 0).all() or k < shown)
        values = np.array(asked[1:]).astype(one.dtype) * one.dtype(p["resolution"])
        wrong["in force but not as asked"] += int((values != force[k].astype(one.dtype)).any() or asked[0] != last)
        if max(np.abs(asked)) > LARGEST or asked[0] < 1:
            wrong["beyond the range"] += 1
            continue
        request = Request(*(int(value) for value in asked), int(p["block_key"]))
        wrong["checksum wrong"] += int(request.checksum != i["CHECKSUM"][k])
        first, second = (p.get(name, 0.0) for name in (one.specification.first, one.specification.second))
        far = force[k, 0] > p["factor"] or abs(force[k, 1] - first) > p["first_range"] * (1 + 1e-6)
        wrong["beyond the range"] += int(far or abs(force[k, 2] - second) > p["second_range"] * (1 + 1e-6))
    return wrong


def beats(heartbeat, cold):
    """Scans in which a usable heartbeat differs from the last usable one since the start."""
    found, last = np.zeros(len(cold), dtype=bool), 0.0
    for k, value in enumerate(heartbeat):
        if cold[k]:
            last = 0.0
        if 0 <= value <= LARGEST and value != last:
            found[k] = not cold[k]
            last = value
    return found


def scans_since(events, cold):
    """Scans since the last event after the last cold start; many where there was none."""
    index = np.arange(len(events))
    last = np.maximum.accumulate(np.where(events, index, -1))
    start = np.maximum.accumulate(np.where(cold, index, -1))
    return np.where(last > start, index - last, 10**9)


def run_length(flags):
    """Length of the run of true flags that ends at each place."""
    index = np.arange(len(flags))
    return index - np.maximum.accumulate(np.where(flags, -1, index))
