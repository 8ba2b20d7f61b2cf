"""The three stiction models, each in the words and the variables of its paper. Parameters may be complex."""

import numpy as np


def sign(value):
    return int(value > 0) - int(value < 0)


def choudhury(u, band, jump, start):
    """Choudhury et al. 2005: xss is the input where the valve got stuck, I tells a stop without a turn."""
    y, xss, stuck, indicator, way = start, None, True, False, 0
    positions, old = [], start
    for x in u:
        new_way = sign(x - old)
        if new_way == 0 and not stuck:  # the slope goes to zero: sticks in the moving phase
            stuck, indicator, xss = True, True, old
        elif new_way == -way != 0:  # the slope changes its sign
            stuck, indicator, xss = True, False, old
        if new_way != 0:
            way = new_way
            if xss is None:  # in the middle of the band, half of it and half the jump from either end
                moved, threshold = x - start, (band + jump) / 2
            else:
                moved, threshold = x - xss, jump if indicator else band
            if not stuck or abs(np.real(moved)) > np.real(threshold):
                stuck = False
                y = x - way * (band - jump) / 2
        positions.append(y)
        old = x
    return np.array(positions)


def kano(u, band, jump, start):
    """Kano et al. 2004: stp is 1 at rest, u_s the controller output where it came to rest, d the friction's way."""
    d, stp, y = 1, 1, start
    u_s = start + d * (band - jump) / 2
    old, old_change, positions = start, 0.0, []
    for new in u:
        change = new - old
        if stp == 0 and change * old_change <= 0:
            u_s, stp = old, 1
        if stp == 0:
            y = new - d * (band - jump) / 2
        elif np.real(-d * (new - u_s)) > np.real(band):
            d, stp = -d, 0
            y = new - d * (band - jump) / 2
        elif np.real(d * (new - u_s)) > np.real(jump):
            stp = 0
            y = new - d * (band - jump) / 2
        positions.append(y)
        old, old_change = new, change
    return np.array(positions)


def he(u, band, jump, start):
    """He et al. 2007: u_r is the force that has built up and moved nothing yet."""
    fs, fd = (band + jump) / 2, (band - jump) / 2
    uv, u_r, old, positions = start, 0.0, start, []
    for new in u:
        cum_u = u_r + (new - old)
        if abs(np.real(cum_u)) > np.real(fs):
            way = sign(np.real(cum_u))
            uv = uv + cum_u - way * fd
            u_r = way * fd
        else:
            u_r = cum_u
        positions.append(uv)
        old = new
    return np.array(positions)


def he_ramp(u, band, jump, start):
    """He's valve behind a command that goes in straight lines: slip by slip, each when the force is enough."""
    fs, uv, old, means = (band + jump) / 2, start, start, []
    for new in u:
        mean = uv
        while abs(np.real(new - uv)) > np.real(fs):
            way = sign(np.real(new - uv))
            when = (uv + way * fs - old) / (new - old) if new != old else 0.0
            if not 0.0 < np.real(when) < 1.0:
                when = min(max(np.real(when), 0.0), 1.0)
            mean = mean + way * jump * (1.0 - when)
            uv = uv + way * jump
        means.append(mean)
        old = new
    return np.array(means)


MODELS = {"choudhury": choudhury, "kano": kano, "he": he, "he ramp": he_ramp}
STEP = 1e-30


def derivatives(model, u, band, jump, start):
    """dx by band and jump between the break-aways, shape (2, n), by the complex step."""
    by_band = MODELS[model](u, band + 1j * STEP, complex(jump), complex(start)).imag / STEP
    by_jump = MODELS[model](u, complex(band), jump + 1j * STEP, complex(start)).imag / STEP
    return np.array([by_band, by_jump])
