"""Closed loop of a PI controller, an inverse, an actuator and a linear process, one sample after the other."""

from tests.naive.dead_zone import dead_zone, inverse


def limited_pi(error, integral, kp, ki_dt, low, high):
    """Output and new integral: while the output is at a limit, the integral may only move away from it."""
    wanted = integral + ki_dt * error
    output = kp * error + wanted
    if output > high:
        return high, wanted if wanted < integral else integral
    if output < low:
        return low, wanted if wanted > integral else integral
    return output, wanted


def closed_loop(
    a, b, delay, offset, zone, undo, kp, ki_dt, low, high, bias, reference, disturbance, noise,
):  # fmt: skip
    """Lists of control, command, x, output and measured output; `zone` and `undo` may be None.

    `zone` may also be a function from all commands so far to all positions: an actuator with memory.
    """
    control, command, x, output, measured, z = [], [], [], [], [], []
    integral = bias
    for k, wanted in enumerate(reference):
        value = 0.0
        for i, coefficient in enumerate(b):
            if k - delay - i >= 0:
                value += coefficient * x[k - delay - i]
        for j, coefficient in enumerate(a, start=1):
            if k - j >= 0:
                value -= coefficient * z[k - j]
        z.append(value)
        output.append(value + offset + disturbance[k])
        measured.append(output[-1] + noise[k])
        out, integral = limited_pi(wanted - measured[-1], integral, kp, ki_dt, low, high)
        control.append(out)
        command.append(out if undo is None else inverse(out, *undo))
        if callable(zone):
            x.append(zone(command)[-1])
        else:
            x.append(command[-1] if zone is None else dead_zone(command[-1], *zone))
    return control, command, x, output, measured
