"""Virtual commissioning: the exported block in a loop with the simulated tank, before anyone touches the plant.

Run ``python examples/virtual_commissioning.py`` (``make plc`` first, for the ST machine). It records the loop with the
block in the PLC but off, identifies the valve from that record, makes the block, says what `simulate` expects of it,
downloads it, switches it on and off, and lets a transmitter fail (about 1 minute); then it writes
docs/commissioning-example.md.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))
from benchmarks.pages import publish

import lostmotion as lm
from lostmotion.plot.style import ALERT, MEASURED, MODEL, calm, new_figure
from lostmotion.simulate.platforms.level_tank import DEAD_TIME, DT, NOISE_VARIANCE, TANK, VALVE
from plc import COUNTS, OUTPUTS, best_plc

SCAN, FINE = DT, 5  # seconds; steps of the plant in a scan
VALVE_FAULT = lm.DeadZone(49.0, 51.0, 3.0, 3.0)  # the paper's, around 50 % of OP
CONTROLLER = lm.PI(kp=0.5, ki=0.7, low=0.0, high=100.0)
KNOWN_GAIN = 2.2222  # of the tank: level per unit of valve flow
MINUTE = 600  # scans
SPAN = (0.0, 100.0)
DOCS = Path(__file__).resolve().parents[1] / "docs"
SIGNALS = ("sp", "pv", *OUTPUTS)


class Plant:
    """Valve with a dead zone, tank and transport delay, five steps a scan; level in %."""

    def __init__(self) -> None:
        num = [VALVE[0][0] * TANK[0][0]]
        den = np.polymul(VALVE[1], TANK[1])
        self._linear = lm.LinearModel.from_continuous(num, den, DEAD_TIME - DT, SCAN / FINE)
        self._x = [0.0] * (self._linear.delay + len(self._linear.b))
        self._y = [0.0] * len(self._linear.a)

    @property
    def level(self) -> float:
        """Level now."""
        return 50.0 + self._y[0]

    def move(self, op: float) -> None:
        """A scan with the valve commanded to `op`."""
        a, b, delay = self._linear.a, self._linear.b, self._linear.delay
        for _ in range(FINE):
            self._x = [float(np.asarray(VALVE_FAULT(op))), *self._x[:-1]]
            past = self._x[delay - 1 : delay - 1 + len(b)]
            level = sum(map(float.__mul__, b, past)) - sum(map(float.__mul__, a, self._y))
            self._y = [level, *self._y[:-1]]


def operate(plc: object, sp: np.ndarray, seed: int, on: np.ndarray, manual: np.ndarray, bad: np.ndarray) -> dict:
    """Run the loop; signals by name. Where `bad` the transmitter sends 0 and says so."""
    plant, random = Plant(), np.random.default_rng(seed)
    rows = []
    hand = 50.0
    for k in range(sp.size):
        pv = plant.level + random.normal(scale=NOISE_VARIANCE**0.5)
        raw = 0 if bad[k] else round(min(max(pv, 0.0), 100.0) * COUNTS)
        found = plc.scan(float(sp[k]), raw, bool(on[k]), not bad[k], bool(manual[k]), hand)
        hand = found[1] if not manual[k] else hand
        plant.move(found[5] / COUNTS)
        rows.append((sp[k], raw / COUNTS, *found))
    return dict(zip(SIGNALS, np.array(rows).T, strict=True))


def set_point(minutes: int, seed: int) -> np.ndarray:
    """49, 50 or 51 %, drawn anew every 30 s."""
    return np.repeat(50.0 + np.random.default_rng(seed).choice([-1.0, 0.0, 1.0], 2 * minutes), MINUTE // 2)


def never(n: int) -> np.ndarray:
    """A flag that stays off."""
    return np.zeros(n, dtype=bool)


def error(run: dict) -> float:
    """Integral absolute error per scan, from the second minute on."""
    return float(np.mean(np.abs(run["sp"] - run["pv"])[MINUTE:]))


def main() -> None:
    """Record, identify, expect, download, switch, fail; write the page."""
    plc = best_plc()
    print(f"The block is executed as {plc.what}.")
    sp = set_point(6, 1)
    idle = lm.block_from_model(lm.DeadZone(50.0, 50.0), SCAN)
    before = operate(plc(idle, CONTROLLER, 50.0), sp, 1, never(sp.size), never(sp.size), never(sp.size))
    record = lm.LoopRecord(before["op_out"], before["pv"], before["sp"], dt=SCAN, op_span=SPAN, tag="LIC-101")
    fit = lm.identify(record, gain=KNOWN_GAIN, nonlinearity="dead zone")
    study = lm.compensation_study(fit, record=record)
    print(study.summary())
    after = operate(plc(study.block, CONTROLLER, 50.0), sp, 1, ~never(sp.size), never(sp.size), never(sp.size))
    trial = commission(plc, study.block)
    checks = check(trial, study.block)
    draw(trial, DOCS / "images")
    page = write_page(plc.what, fit, study, (error(before), error(after)), checks)
    print(f"\n{page.read_text(encoding='utf-8')}\nWritten: {page}")
    if not all(passed for _, passed in checks):
        sys.exit(1)


def commission(plc: type, block: lm.CompensatorBlock) -> dict:
    """6 minutes off, 6 on, then manual, a failed transmitter, off and on."""
    sp = set_point(15, 2)
    n = sp.size
    on, manual, bad = never(n), never(n), never(n)
    on[6 * MINUTE :] = True
    manual[12 * MINUTE + 100 : 12 * MINUTE + 250] = True
    bad[13 * MINUTE : 13 * MINUTE + 50] = True
    on[13 * MINUTE + 300 : 14 * MINUTE] = False
    run = operate(plc(block, CONTROLLER, 50.0), sp, 2, on, manual, bad)
    return {**run, "on": on, "manual": manual, "bad": bad}


def check(run: dict, block: lm.CompensatorBlock) -> list[tuple[str, bool]]:
    """What must hold, in words, and whether it does."""
    hand = np.r_[50.0, run["op_out"][:-1]]
    held = np.zeros_like(hand)
    for k in range(hand.size):  # the operator takes over at the last command
        held[k] = held[k - 1] if run["manual"][k] and run["manual"][k - 1] else hand[k]
    twin = block.run(run["op_in"], run["on"], ~run["bad"], run["manual"], held)
    apart = float(np.max(np.abs(twin.op_out - run["op_out"])))
    switched = np.flatnonzero(np.diff(run["on"].astype(int)) | np.diff(run["manual"].astype(int))) + 1
    steps = np.abs(np.diff(run["offset"]))[switched - 1]
    ramp = block.settings["ramp_step"]
    return [
        (f"OP_OUT is that of the simulated block in every scan (largest difference {apart:.1e})", apart < 1e-12),
        (f"every command is a number within {SPAN[0]:g} .. {SPAN[1]:g} %",
         bool(np.isfinite(run["op_out"]).all() and run["op_out"].min() >= SPAN[0] and run["op_out"].max() <= SPAN[1])),
        (f"switching on, off, to manual and back moves the offset by at most its ramp, {ramp:.4f} "
         f"(largest {steps.max():.4f})", bool(steps.max() <= ramp + 1e-12)),
        ("while the transmitter has failed the state is 4 and the block passes the held OP through, by its ramp",
         bool((run["state"][run["bad"]] == 4).all() and run["offset"][run["bad"]][-1] == 0.0
              and np.abs(np.diff(run["offset"])[run["bad"][1:]]).max() <= ramp + 1e-12)),
        ("in manual the state is 3 and the command is the operator's",
         bool((run["state"][run["manual"]] == 3).all() and np.ptp(run["op_out"][run["manual"]]) == 0.0)),
    ]  # fmt: skip


def draw(run: dict, folder: Path) -> None:
    """Before and after; the switches."""
    time = np.arange(run["sp"].size) * SCAN
    figure = new_figure(11.0, 6.0)
    above, below = figure.subplots(2, 1, sharex=True)
    rows = slice(4 * MINUTE, 8 * MINUTE)
    above.plot(time[rows], run["pv"][rows], color=MEASURED, lw=0.7, label="PV")
    above.plot(time[rows], run["sp"][rows], color=ALERT, lw=1.3, ls="--", label="SP")
    below.plot(time[rows], run["op_out"][rows], color=MODEL, lw=0.8, label="to the valve")
    below.plot(time[rows], run["op_in"][rows], color=ALERT, lw=0.8, alpha=0.8, label="of the controller")
    for axes in (above, below):
        axes.axvline(6 * MINUTE * SCAN, color="0.3", lw=1.0)
        axes.margins(x=0.0)
        axes.legend(fontsize=8, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0)
    calm(above, "Level before and after the block is switched on (line)", "", "%")
    calm(below, "Command", "time, s", "OP, %")
    figure.savefig(folder / "commissioning-before-after.png", dpi=80)

    figure = new_figure(11.0, 7.0)
    panels = figure.subplots(3, 1, sharex=True)
    rows = slice(12 * MINUTE, 14 * MINUTE + 300)
    for name, colour in (("op_out", MODEL), ("op_in", ALERT)):
        panels[0].plot(time[rows], run[name][rows], color=colour, lw=0.8,
                       label="to the valve" if name == "op_out" else "of the controller")  # fmt: skip
    panels[0].legend(
        fontsize=8, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0
    )
    panels[1].plot(time[rows], run["offset"][rows], color=MODEL, lw=0.8)
    panels[2].step(time[rows], run["state"][rows], color=MODEL, lw=1.0, where="post")
    for flag, name, colour in (("manual", "manual", "0.85"), ("bad", "PV bad", "#f4cccc")):
        at = np.flatnonzero(run[flag])
        for axes in panels:
            axes.axvspan(time[at[0]], time[at[-1]], color=colour, lw=0)
        panels[2].text(time[at[0]], 2.4, f" {name}", fontsize=9, va="center")
    off = np.flatnonzero(~run["on"][rows]) + rows.start
    for axes in panels:
        axes.axvspan(time[off[0]], time[off[-1]], color="#d9ead3", lw=0)
        axes.margins(x=0.0)
    panels[2].text(time[off[0]], 2.4, " off", fontsize=9, va="center")
    panels[2].set_yticks(range(5), ["first scan", "passing", "compensating", "manual", "bad input"])
    calm(panels[0], "Command", "", "OP, %")
    calm(panels[1], "Offset that the block adds", "", "OP, %")
    calm(panels[2], "State", "time, s", "")
    figure.savefig(folder / "commissioning-switches.png", dpi=80)


def write_page(
    what: str,
    fit: lm.HammersteinFit,
    study: lm.CompensationStudy,
    errors: tuple[float, float],
    checks: list[tuple[str, bool]],
) -> Path:
    """docs/commissioning-example.md."""
    off, on = errors
    said = study.cases["with"].ratio
    lines = [
        "# Virtual commissioning of an exported block",
        "",
        f"Made by `python examples/virtual_commissioning.py` (after `make plc`). Executed as {what}.",
        "",
        f"Plant: the paper's level tank, simulated at {SCAN / FINE:g} s; valve with a dead zone 49 .. 51 % of OP and "
        f"slopes of 3. PLC: scan {SCAN:g} s, PV and OP through cards of 27648 counts for 100 %, PI with Kp "
        f"{CONTROLLER.kp:g} and Ki {CONTROLLER.ki:g} 1/s, its anti-windup on the block's output BACK; white noise of "
        f"{NOISE_VARIANCE**0.5:.2g} % in PV.",
        "",
        "1. **Record** 6 minutes of routine operation, the block in the program but off, set point 49, 50 or 51 %.",
        f"2. **Identify**: status {fit.status.name}, dead zone {fit.parameters['left']:.3f} .. "
        f"{fit.parameters['right']:.3f} (standard errors {fit.standard_errors['left']:.3f}, "
        f"{fit.standard_errors['right']:.3f}; truth 49 .. 51), factor of the block "
        f"{study.block.settings['factor']:.3f}.",
        f"3. **Evaluate before download** (`lostmotion simulate`): {study.reasons[0]} Expected IAE with the block: "
        f"{100 * said:.0f} % of that without.",
        "4. **Download, switch on** at 360 s.",
        "",
        "![Level and command before and after](images/commissioning-before-after.png)",
        "",
        "| the 6 minutes of the record, again | off | on | ratio | expected by `simulate` |",
        "|---|---|---|---|---|",
        f"| IAE, % of level | {off:.3f} | {on:.3f} | {on / off:.2f} | {said:.2f} |",
        "",
        "Set point and noise are the same with and without; `simulate` has other noise, from the model of the fit, and "
        "ten runs.",
        "",
        "5. **Try what will happen**: to manual and back, a transmitter that fails (sends 0 and says so), off and on.",
        "",
        "![Manual, failed transmitter, off and on](images/commissioning-switches.png)",
        "",
        "| check | |",
        "|---|---|",
        *(f"| {text} | {'passed' if passed else 'FAILED'} |" for text, passed in checks),
        "",
        "While the transmitter fails, the PI of this program rests; one that goes on would run to its limit, block or "
        "no block.",
        "",
        "No vendor's tool has seen this code: the machine is that of pyplcopen.",
        "",
    ]
    path = DOCS / "commissioning-example.md"
    publish(path, "\n".join(lines))
    return path


if __name__ == "__main__":
    main()
