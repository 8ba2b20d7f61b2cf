"""The compensating blocks once more, in plain words: one class, Python floats, branches by case.

Written from the description of the blocks, not from the kernels: a single method per question, no flags in arrays.
"""

import math


def clamp(value, low, high):
    return low if value < low else high if value > high else value


def sized(values, most=1e9):
    return all(v == 0 or 2**-40 <= abs(v) <= most for v in values)  # NaN is neither


def usable_limits(p):
    values = [p["low"], p["high"], p["safe"], p["ramp_step"]]
    return sized(values) and p["low"] <= p["high"] and p["ramp_step"] >= 0


def usable_common(p):
    values = [p[name] for name in ("factor", "band", "quiet", "rate", "cap", "count_limit")]
    return sized(values) and sized(values[:1], 2) and min(values) >= 0 and p["count_limit"] >= 1


class DeadZone:
    moving = ("left_break", "right_break", "centre", "left_slope", "right_slope", "shape", "zone")
    own = (*moving, "hunt_scans", "hunt_limit", "back_off")

    def __init__(self):
        self.place, self.part, self.side, self.changes = 0.0, 1.0, 0.0, []
        self.now = 0

    def usable(self, p):
        return (
            sized(p[name] for name in self.own)
            and p["left_break"] <= p["centre"] <= p["right_break"]
            and min(p["left_slope"], p["right_slope"]) > 0
            and min(p["zone"], p["hunt_scans"], p["back_off"]) >= 0
            and p["hunt_limit"] >= 1
            and p["back_off"] <= 1
        )

    def watch_for_hunting(self, b, p):
        """`changes`: since when the scans count, then the changes that followed each other fast."""
        if not b.enabled or b.first:
            self.part, self.side, self.changes = 1.0, 0.0, []
            self.now = p["hunt_scans"]
        elif b.active:
            self.now += float(self.now < p["hunt_scans"])
            if self.place * self.side < 0:
                self.changes = [*self.changes, self.now] if self.now < p["hunt_scans"] else []
                self.now = 0
                if len(self.changes) >= p["hunt_limit"]:
                    self.changes, self.part = [], self.part * p["back_off"]
            if self.place != 0:
                self.side = math.copysign(1.0, self.place)

    def choose_place(self, p, v):
        if p["shape"] > 1:
            return 1.0 if v > p["zone"] else -1.0 if v < -p["zone"] else self.place
        if p["shape"] == 1 and abs(v) < p["zone"]:
            return v / p["zone"]
        return float(v > 0) - float(v < 0)

    def wanted(self, b, p):
        v = b.quieted - p["centre"]
        if b.alive and not b.frozen:
            self.place = self.choose_place(p, v)
        self.watch_for_hunting(b, p)
        factor = p["factor"] * self.part
        if self.place == 0:
            gained, level = 0.0, 0.0
        elif self.place > 0:
            gained, level = v / p["right_slope"] - v, (p["right_break"] - p["centre"]) * factor * self.place
        else:
            gained, level = v / p["left_slope"] - v, (p["centre"] - p["left_break"]) * factor * self.place
        return gained + level

    def inverse(self, b, p, command):
        shift = command - p["centre"]
        found = 0.0
        if shift != 0:
            way = 1.0 if shift > 0 else -1.0
            side, slope = ("right_break", "right_slope") if way > 0 else ("left_break", "left_slope")
            level = abs(p[side] - p["centre"]) * p["factor"] * self.part
            smooth = p["shape"] == 1
            knee = level + p["zone"] / p[slope] if smooth else level
            if abs(shift) > knee:
                found = way * (abs(shift) - level) * p[slope]
            elif smooth and knee > 0:
                found = way * abs(shift) / knee * p["zone"]
        if b.tracking:
            self.place = float(found > 0) - float(found < 0)
        return p["centre"] + found


class Backlash:
    own = ("lead_up", "lead_down", "pulse", "pulse_scans")
    moving = ("lead_up", "lead_down")

    def __init__(self):
        self.pushed, self.left = 0.0, 0.0

    def usable(self, p):
        values = [p[name] for name in self.own]
        return sized(values) and min(values) >= 0

    def lead(self, p):
        return {1.0: p["lead_up"], -1.0: -p["lead_down"], 0.0: 0.0}[self.pushed] * p["factor"]

    def wanted(self, b, p):
        if not b.frozen and self.pushed != b.side:
            self.pushed = b.side
            if b.active:
                self.left = p["pulse_scans"]
        total = self.lead(p)
        if not b.active or b.frozen:
            self.left = 0.0
        elif self.left > 0:
            self.left -= 1
            total += self.pushed * p["pulse"]
        return total

    def inverse(self, b, p, command):
        return command - self.lead(p)


class Knocker:
    own = ("amplitude", "pulse_scans", "period_scans")
    moving = ("amplitude",)

    def __init__(self):
        self.clock, self.reference, self.way = 0.0, 0.0, 0.0

    def usable(self, p):
        values = [p[name] for name in self.own]
        return sized(values) and p["amplitude"] >= 0 and 1 <= p["pulse_scans"] <= p["period_scans"]

    def wanted(self, b, p):
        if not (b.active and b.was_active) or b.frozen:
            self.clock, self.reference, self.way = 0.0, b.quieted, 0.0
            return 0.0
        self.clock += 1
        if self.clock >= p["period_scans"]:
            self.clock = 0.0
            move = b.quieted - self.reference
            up, down = b.quieted > self.reference + p["band"], b.quieted < self.reference - p["band"]
            self.way = float(up) - float(down)
            if up or down:
                self.reference += move
        return p["amplitude"] * p["factor"] * self.way if self.clock < p["pulse_scans"] else 0.0

    inverse = None


class TwoMoves:
    own = ("overshoot", "stand", "move_scans", "share", "release")
    moving = ("overshoot", "stand")

    def __init__(self):
        self.phase, self.seen, self.peak, self.trough = "watch", 0, 0.0, 0.0
        self.aim = self.way = self.clock = self.hold_in = 0.0

    def usable(self, p):
        fine = sized(p[name] for name in self.own)
        return fine and min(p["overshoot"], p["release"]) >= 0 and p["move_scans"] >= 1 and 0 <= p["share"] <= 1

    def advance(self, b, p):
        if self.phase == "watch":
            if b.turned:
                if b.side < 0:
                    self.peak = b.turn_point
                else:
                    self.trough = b.turn_point
                self.seen += 1
                if self.seen > 1:
                    self.aim = self.trough + (self.peak - self.trough) * p["share"]
                    self.way, self.phase, self.clock = b.side, "move", 0.0
        elif self.phase == "move":
            self.clock += 1
            if self.clock >= p["move_scans"]:
                self.phase, self.hold_in = "hold", b.quieted
        elif abs(b.quieted - self.hold_in) > p["release"]:
            self.phase, self.seen, b.changed = "watch", 0, True

    def wanted(self, b, p):
        if not b.active:
            self.phase, self.seen = "watch", 0
        elif not b.frozen:
            self.advance(b, p)
        if self.phase == "watch":
            return 0.0
        target = self.aim + self.way * p["factor"] * (p["overshoot"] if self.phase == "move" else -p["stand"])
        return target - b.quieted  # the play adds what is missing to BASE

    inverse = None


class NaiveBlock:
    """One block of any kind; `scan` takes the settings by name and the five inputs."""

    def __init__(self, kind):
        self.kind = {
            "dead zone": DeadZone, "backlash": Backlash, "stiction knocker": Knocker, "stiction two moves": TwoMoves
        }[kind]()  # fmt: skip
        self.limits = self.settings = self.base = self.quieted = self.command = None
        self.sensed = self.extreme = self.turn_point = 0.0
        self.side, self.turns, self.applied, self.held, self.target = 0.0, 0, 0.0, 0.0, 0.0
        self.first, self.chasing, self.active, self.tracking = True, False, False, False

    def scan(self, p, op_in, enable, good, track, track_value):
        self.changed, self.enabled = False, bool(enable)
        error = self.accept(p)
        mode = self.choose_mode(op_in, enable, good, track, track_value)
        self.follow_direction(mode)
        if self.settings is not None and self.quieted is not None:
            self.target = self.kind.wanted(self, self.settings) + self.quieted - (self.base or 0.0)
        elif isinstance(self.kind, Backlash):
            self.kind.pushed = self.side
        elif isinstance(self.kind, DeadZone):
            self.kind.watch_for_hunting(self, self.settings or {"hunt_scans": 0.0})
        cut, capped, low, high = self.move(p, mode, op_in, enable, good, track_value)
        back = self.back(mode, enable, cut, capped)
        state = self.state(mode, good)
        if self.limits is not None:
            self.first = False
        return {
            "op_out": self.command, "offset": self.applied, "back": back, "direction": self.side,
            "reversals": self.turns, "state": state, "limited_low": low, "limited_high": high,
            "offset_capped": capped, "error": error,
            "ramping": mode == "auto" and self.limits is not None and self.chasing,
        }  # fmt: skip

    def accept(self, p):
        error = 0 if self.kind.usable(p) else 3
        if not usable_common(p):
            error = 2
        if not usable_limits(p):
            error = 1
        else:
            self.limits = p["low"], p["high"], clamp(p["safe"], p["low"], p["high"]), p["ramp_step"]
        if error == 0:
            old = self.settings
            names = ("factor", "cap", "quiet", *self.kind.moving)
            self.changed = old is None or any(p[name] != old[name] for name in names)
            self.settings = dict(p)
            if self.changed and isinstance(self.kind, DeadZone):
                self.kind.part, self.kind.changes = 1.0, []
        return error

    def choose_mode(self, op_in, enable, good, track, track_value):
        self.was_active, self.was_tracking = self.active, self.tracking
        usable = math.isfinite(op_in) and self.limits is not None
        if self.limits is not None:
            if usable:
                self.base = clamp(op_in, *self.limits[:2])
            elif self.base is not None:
                self.base = clamp(self.base, *self.limits[:2])
        if track:
            mode = "track" if math.isfinite(track_value) and self.limits is not None else "hold"
        elif not usable:
            mode = "hold"
        else:
            mode = "auto"
        self.tracking = mode == "track"
        self.alive = mode == "auto" and bool(good)
        self.active = self.alive and bool(enable) and self.settings is not None
        self.frozen = self.active and self.was_active and (self.chasing or self.changed)
        return mode

    def follow_direction(self, mode):
        settings = self.settings or {"quiet": 0.0, "band": 0.0, "count_limit": 0.0}
        if self.alive:
            if self.quieted is None:
                self.quieted = self.extreme = self.base
            elif self.base > self.quieted + settings["quiet"]:
                self.quieted = self.base - settings["quiet"]
            elif self.base < self.quieted - settings["quiet"]:
                self.quieted = self.base + settings["quiet"]
            self.sensed = self.quieted
        elif self.tracking:
            self.sensed = 0.0 if self.command is None else self.command
        if self.tracking != self.was_tracking:
            self.extreme = self.sensed
        self.see_turn(settings)

    def see_turn(self, settings):
        self.turned = False
        up = self.sensed > self.extreme + settings["band"]
        down = self.sensed < self.extreme - settings["band"]
        if self.side == 0:
            if up or down:
                self.side, self.extreme = (1.0 if up else -1.0), self.sensed
            return
        self.turned = down if self.side > 0 else up
        if self.turned:
            self.side, self.turn_point, self.extreme = -self.side, self.extreme, self.sensed
            self.turns += 1
            if self.turns >= settings["count_limit"]:
                self.turns = 0
        elif self.side * (self.sensed - self.extreme) > 0:
            self.extreme = self.sensed

    def move(self, p, mode, op_in, enable, good, track_value):
        if self.limits is None:
            self.command = p["safe"] if abs(p["safe"]) <= 1e9 else 0.0
            return False, False, False, False
        low, high, safe, ramp = self.limits
        if mode != "auto":
            asked = track_value if mode == "track" else self.command if not self.first else safe
            self.command = clamp(asked, low, high)
            if self.base is not None:
                self.applied = self.command - self.base
            self.chasing = True
            return False, False, asked < low, asked > high
        capped = self.limit_target(enable, good)
        reach = ramp if self.chasing else self.settings["rate"]
        reach = 0.0 if self.first else reach
        if abs(self.target - self.applied) <= reach:
            self.applied, self.chasing = self.target, False
        else:
            self.applied += math.copysign(reach, self.target - self.applied)
        if self.active:
            self.held = clamp(self.applied, -self.settings["cap"], self.settings["cap"])
        total = self.base + self.applied
        self.command = clamp(total, low, high)
        cut = total < low or total > high
        return cut, capped, op_in < low or total < low, op_in > high or total > high

    def limit_target(self, enable, good):
        if not self.active:
            hold = self.settings is not None and self.settings["hold_on_disable"] and not enable and good
            self.target = self.held if hold else 0.0
            self.chasing = True
            return False
        cap = self.settings["cap"]
        capped = math.isnan(self.target) or abs(self.target) > cap
        self.target = 0.0 if math.isnan(self.target) else clamp(self.target, -cap, cap)
        if not self.was_active or self.changed:
            self.chasing = True
        return capped

    def back(self, mode, enable, cut, capped):
        if self.limits is None:
            return self.command
        inverse = self.kind.inverse
        if mode != "auto":
            back = self.command
            if self.settings is not None and enable and inverse:
                back = inverse(self, self.settings, self.command)
            elif self.settings is not None and not enable and self.settings["hold_on_disable"]:
                back = self.command - self.held
        elif not cut:
            back = self.base
        elif self.active and not capped and self.applied == self.target and inverse:
            back = inverse(self, self.settings, self.command)
        else:
            back = self.command - self.applied
        back = clamp(back, *self.limits[:2])
        if mode == "track":
            self.quieted = self.sensed = back
        return back

    def state(self, mode, good):
        if self.first:
            return 0
        if mode == "track":
            return 3
        if mode == "hold" or not good:
            return 4
        return 2 if self.active else 1
