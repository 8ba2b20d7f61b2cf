"""Recursive estimation with key-term separation: lists of all past samples, outer products, the paper's equations."""

import numpy as np

from tests.naive.dead_zone import dead_zone
from tests.naive.linear import largest_root

LARGEST_RATIO = 10.0
SINGULAR = 1e-6


def at(past, k):
    """Sample k of a list, zero before the first one."""
    return past[k] if k >= 0 else 0.0


class Recursion:
    """theta, P and zone = [left, right, left slope, right slope] after every sample; names as in the paper."""

    def __init__(
        self,
        na,
        nb,
        delay,
        gain,
        forgetting,
        *,
        method="riv",
        form="convergent",
        start_samples=0,
        constant_for=2000,
        dense=2000,
    ):
        self.na, self.nb, self.delay, self.gain = na, nb, delay, gain
        self.method, self.printed = method, form == "printed"
        self.start_samples = 0 if self.printed else start_samples
        self.lambda0, self.constant_for = forgetting, constant_for
        self.ne = na if method == "els" else 0
        n = na + nb + 4 + self.ne
        self.theta = np.full(n, 10.0) if self.printed else np.zeros(n)
        self.p = np.eye(n) * (1e6 if self.printed else 1e3)
        self.zone = np.array([0.0, 0.0, 1.0, 1.0])
        self.stable_theta = np.zeros(n)
        self.u, self.y, self.y_model, self.x, self.residuals, self.lambdas = [], [], [], [], [], []
        self.phis, self.zs = [], []
        self.theta_room, self.p_room = np.zeros(n), np.zeros((n, n))  # see weigh_rounding
        self.dense = dense
        self.instruments, self.errors = [], []  # z and prediction error of every sample
        self.gathered = []  # (k, A z, z, sum of b_i dx(k-d-i)/dzone, y - y_model), from start_samples on

    def regressor(self, k):
        """Phi of eq 23, and the past residuals of extended least squares."""
        u = at(self.u, k - self.delay)
        left, right = self.zone[:2]
        over, under = float(u > right), float(u < left)
        past_y = [-at(self.y, k - i) for i in range(1, self.na + 1)]
        past_x = [at(self.x, k - i) for i in range(1, self.nb + 1)]  # x[k] is x(k-d)
        past_e = [at(self.residuals, k - i) for i in range(1, self.ne + 1)]
        return np.array([*past_y, over * u, -over, under * u, -under, *past_x, *past_e])

    def instrument(self, k, phi):
        if self.method != "riv" or k < self.start_samples:
            return phi.copy()
        past_model = [at(self.y_model, k - i) for i in range(1, self.na + 1)]
        if self.printed:  # eq 20, filled up with older inputs
            return np.array([*past_model, *(at(self.u, k - self.delay - i) for i in range(phi.size - self.na))])
        return np.array([*(-value for value in past_model), *phi[self.na :]])

    def forget(self, k):
        """Lambda of sample k (eq 31), counted so that sample `constant_for` still has the constant one."""
        if k < self.constant_for:
            return self.lambda0
        return self.lambda0 * self.lambdas[-1] + 1 - self.lambda0

    def separate(self):
        """Slopes and break points from theta (eqs 24-26)."""
        a, b0_mr, b0_mr_br, b0_ml, b0_ml_bl, b = self.parts()
        if self.printed:
            b0 = b0_mr if self.gain is None else self.gain * (1 + sum(a)) - sum(b)
            if b0 != 0 and b0_mr != 0 and b0_ml != 0:
                self.zone = np.array([b0_ml_bl / b0_ml, b0_mr_br / b0_mr, b0_ml / b0, b0_mr / b0])
            return
        if 1 + sum(a) <= 0 or b0_mr == 0 or b0_ml == 0:
            return
        left, right, _, old_mr = self.zone
        mr = 1.0 if self.gain is None else (b0_mr + old_mr * sum(b)) / (self.gain * (1 + sum(a)))
        ratio = b0_ml / b0_mr
        if not (mr > 0 and 1 / LARGEST_RATIO < ratio < LARGEST_RATIO):
            return
        br, bl = b0_mr_br / b0_mr, b0_ml_bl / b0_ml
        right = br if 0 <= br < max(0.0, *self.u) else right
        left = bl if min(0.0, *self.u) < bl <= 0 else left
        self.zone = np.array([left, right, mr * ratio, mr])

    def parts(self):
        na, nb = self.na, self.nb
        return [self.theta[:na], *self.theta[na : na + 4], self.theta[na + 4 : na + 4 + nb]]

    def step(self, u, y):
        """Take one sample; return its prediction error."""
        k = len(self.u)
        self.u.append(u)
        lam = self.forget(k)
        self.lambdas.append(lam)
        phi = self.regressor(k)
        z = self.instrument(k, phi)
        error = y - phi @ self.theta
        self.errors.append(error)
        below = lam + phi @ self.p @ z
        if k >= self.delay and abs(below) > SINGULAR * lam:
            gain = self.p @ z / below
            self.weigh_rounding(phi, z, error, below, lam)
            self.p = (self.p - np.outer(gain, phi) @ self.p) / lam
            self.theta = self.theta + gain * error
            self.separate()
            if largest_root([float(value) for value in self.theta[: self.na]]) < 1:
                self.stable_theta = self.theta.copy()
            self.phis.append((k, phi, y))
            self.zs.append(z)
        past_model = [-at(self.y_model, k - i) for i in range(1, self.na + 1)]
        own = np.array([*past_model, *phi[self.na : self.na + 4 + self.nb]])
        self.y_model.append(own @ self.stable_theta[: own.size])
        self.residuals.append(y - phi @ self.theta)
        self.gather(k, z, y)
        self.x.append(dead_zone(at(self.u, k - self.delay), *self.zone))
        self.y.append(y)
        return error

    def weigh_rounding(self, phi, z, error, below, lam):
        """How large theta and P would be if nothing cancelled: what rounding is relative to."""
        size = np.abs(self.p)
        cancelled = (lam + np.abs(phi) @ size @ np.abs(z)) / abs(below)
        gain = size @ np.abs(z) / abs(below) * cancelled
        self.theta_room = np.abs(self.theta) + gain * (abs(error) + np.abs(phi) @ np.abs(self.theta))
        self.p_room = (size + np.outer(gain, np.abs(phi) @ size)) / lam

    def gather(self, k, z, y):
        self.instruments.append(z)
        if k < self.start_samples:
            return
        a, *_, b = self.parts()
        filtered = z + sum(a[j - 1] * self.instruments[k - j] for j in range(1, self.na + 1) if k >= j)
        rebuilt = np.zeros(4)
        for i in range(1, self.nb + 1):
            rebuilt = rebuilt + b[i - 1] * self.slopes_of_x(at(self.u, k - self.delay - i))
        self.gathered.append((k, filtered, z, rebuilt, y - self.y_model[k]))

    def slopes_of_x(self, u):
        """dx/dzone at the present zone."""
        left, right, left_slope, right_slope = self.zone
        over, under = float(u > right), float(u < left)
        return np.array([-under * left_slope, -over * right_slope, under * (u - left), over * (u - right)])

    def share(self, k, seen):
        """How often sample k is counted in the averages: every one, or every eighth eight times."""
        if seen < self.dense:
            return 1
        return 8 if (k * 0.6180339887498949) % 1 < 1 / 8 else 0

    def information(self):
        """S, W and the sums over samples since the instruments are used; sample k weighs all later lambdas."""
        n = self.theta.size
        outer, moved, seen, seen_squared, squares = np.zeros((n, n)), np.zeros((n, 4)), 0.0, 0.0, 0.0
        till_now = 0.0
        for k, filtered, z, rebuilt, miss in self.gathered:
            weight = np.prod(self.lambdas[k + 1 :])
            till_now = self.lambdas[k] * till_now + 1
            share = self.share(k, till_now)
            outer += share * weight**2 * miss**2 * np.outer(filtered, filtered)
            moved += share * weight * np.outer(z, rebuilt)
            seen += weight
            seen_squared += weight**2
            squares += weight**2 * miss**2
        return outer, moved, [seen, seen_squared, squares]

    def present_noise(self):
        """Squared miss and prediction error with a memory four times as short as the estimate's."""
        level, seen = np.zeros(2), 0.0
        for k, _, _, _, miss in self.gathered:
            seen = self.lambdas[k] * seen + 1
            share = min(1.0, 4 / seen)
            level = (1 - share) * level + share * np.array([miss**2, self.errors[k] ** 2])
        return level

    def batch(self):
        """Solution of the regularised instrumental-variable equations over all samples at once (theta0 = 0)."""
        left = np.eye(self.theta.size) * 1e-3 * np.prod([self.lambdas[k] for k, _, _ in self.phis])
        right = np.zeros(self.theta.size)
        for (k, phi, y), z in zip(self.phis, self.zs, strict=True):
            weight = np.prod(self.lambdas[k + 1 :])
            left += weight * np.outer(z, phi)
            right += weight * z * y
        return np.linalg.solve(left, right)
