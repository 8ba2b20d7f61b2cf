"""Recursive maximum likelihood by its definitions: lists of all past samples, block sums, numpy.linalg."""

import numpy as np
from scipy.linalg import eigh

from lostmotion.kernels.recursive_ml.follow import FELT
from tests.naive.dead_zone import STEP, dead_zone
from tests.naive.linear import largest_root, simulate

SETTLED = 1e-3  # what is left of an unknown state when it no longer matters
LONGEST = 5000
BRIDGED = 2  # missing commands between two equal ones


def at(past, k):
    """Sample k of a list, zero before the first one."""
    return past[k] if k >= 0 else 0.0


def parts(theta, na, nb):
    """A, B, offset, left, right, log ratio and D."""
    theta = list(theta)
    return [theta[:na], theta[na : na + nb + 1], *theta[na + nb + 1 : na + nb + 5], theta[na + nb + 5 :]]


def errors_from_rest(theta, na, nb, delay, u, y):
    """Prediction errors e = D (y - offset - B/A x) of the whole record, theta frozen, everything zero before it."""
    a, b, offset, left, right, log_ratio, d = parts(theta, na, nb)
    x = [dead_zone(value, left, right, np.exp(log_ratio), 1.0) for value in u]
    v = [y[k] - offset - z for k, z in enumerate(simulate(a, b, delay, x))]
    return np.array([v[k] + sum(d[j - 1] * at(v, k - j) for j in range(1, len(d) + 1)) for k in range(len(v))])


def gradient_from_rest(theta, na, nb, delay, u, y):
    """psi = -de/dtheta of every sample, shape (samples, n), by the complex step."""
    columns = []
    for i in range(len(theta)):
        moved = np.array(theta, dtype=complex)
        moved[i] += 1j * STEP
        columns.append(-errors_from_rest(moved, na, nb, delay, u, y).imag / STEP)
    return np.array(columns).T


def settling_time(a):
    """Samples, doubled from 1 on, until no entry of the power of the companion matrix exceeds SETTLED."""
    if not len(a):
        return 0
    companion = np.vstack([-np.array(a), np.eye(len(a))[:-1]])
    samples = 1
    while samples < LONGEST and np.abs(np.linalg.matrix_power(companion, samples)).max() >= SETTLED:
        samples *= 2
    return min(samples, LONGEST)


def forgotten(h, r, new_h, new_r, tail):
    """What a reference (h, r) and a block that enters it come to: forget a share `tail`, but no more than comes in."""
    if tail > 0:
        mu, w = eigh(new_h, h)  # w' h w = 1: the reference is the sum of (h w)(h w)'
        gone = np.clip(mu, 0.0, tail)
        r = r - sum(share * (h @ column) * (column @ r) for share, column in zip(gone, w.T, strict=True))
        h = h - sum(share * np.outer(h @ column, h @ column) for share, column in zip(gone, w.T, strict=True))
    return h + new_h, r + new_r


def room(h, index):
    """Information about one parameter when all others are unknown."""
    others = [i for i in range(len(h)) if i != index]
    return h[index, index] - h[index, others] @ np.linalg.solve(h[np.ix_(others, others)], h[others, index])


def largest_statistic(blocks, total_h, total_r, variance, na, nb):
    """Largest z of a shift of left, right or the process gain within the newest 1, 2, 4 .. blocks, oldest first.

    At the best estimate from everything a window's score s has covariance variance (H - H T^-1 H).
    """
    eta = na + nb + 2
    best = np.linalg.solve(total_h, total_r)
    gain = np.zeros(best.size)
    gain[na : na + nb + 1] = best[na : na + nb + 1]
    found = 0.0
    for size in (2**i for i in range(20) if 2**i <= len(blocks)):
        h, r = sum(block[0] for block in blocks[-size:]), sum(block[1] for block in blocks[-size:])
        score = r - h @ best
        covariance = variance * (h - h @ np.linalg.solve(total_h, h))
        for c in (np.eye(best.size)[eta], np.eye(best.size)[eta + 1], gain):
            if c @ covariance @ c > 1e-6 * variance * (c @ h @ c):
                found = max(found, c @ score / np.sqrt(c @ covariance @ c), key=abs)
    return found


class Recursion:
    """theta, information and errors after every sample, from a prior N(theta, variance inv(information)) at rest.

    Where the estimate would leave the range of the data or A the stable region, the twin gives up: NotImplementedError.
    """

    def __init__(self, theta, information, na, nb, delay, *, block, ring, tail, keep, clip, offset, variance, weight):
        self.theta, self.na, self.nb, self.delay = np.array(theta), na, nb, delay
        self.p = len(parts(theta, na, nb)[-1])
        self.block, self.ring, self.tail, self.keep, self.clip, self.offset = block, ring, tail, keep, clip, offset
        self.reference = (np.array(information), np.array(information) @ self.theta)
        self.blocks = []  # (H, R) of the whole blocks in the ring, oldest first
        self.open = []  # (psi, error, weight) of the samples since
        self.in_block = 0
        self.squares, self.weight = variance * weight, weight
        self.u, self.y = [], []  # as they act: bridged, and the noise model's own output where y is missing
        self.good_y, self.learned = [], []
        self.x, self.x_slopes, self.w, self.v = [], [], [], []  # (1/A) x, (1/A) dx/deta, -(1/A) z, v
        self.x_d, self.w_d = [], []  # after D
        self.e_slopes = []  # (B/A) dx/deta
        self.low, self.high = -2.0, 2.0  # of the commands that were learned from
        self.waiting = 0  # samples until an unknown command no longer matters; None: the command is unknown
        self.gap = 0

    def known(self, u, use):
        """The command that acts, and whether it may be learned from."""
        last = self.u[-1] if self.u else 0.0
        if np.isnan(u):
            self.gap += 1
            if self.gap > BRIDGED:
                self.waiting = None
            return last, False
        if self.gap and u != last:
            self.waiting = None
        self.gap = 0
        if not use:
            self.waiting = None
            return min(max(u, self.low), self.high), False
        if self.waiting is None:
            self.waiting = settling_time(self.theta[: self.na]) + self.delay + self.nb + 1
        elif self.waiting > 0:
            self.waiting -= 1
        return u, self.waiting == 0

    def step(self, u, y, use=True):
        """Take one sample; return its prediction error."""
        masked = not np.isnan(u) and not use
        u, learn = self.known(u, use)
        self.u.append(u)
        self.y.append(y)
        error, psi = self.filter(y)
        self.good_y.append(not np.isnan(y) and not masked)
        seen = len(self.good_y) > self.p or all(self.good_y)  # at rest before the first
        self.learned.append(learn and seen and all(self.good_y[-self.p - 1 :]))
        if self.learned[-1]:
            self.learn(u, error, psi)
        self.in_block += 1
        if self.in_block == self.block:
            self.close()
        return error

    def filter(self, y):
        """Error and gradient of the newest command by the difference equations."""
        a, b, offset, left, right, log_ratio, d = parts(self.theta, self.na, self.nb)
        k = len(self.u) - 1
        ratio, u = np.exp(log_ratio), at(self.u, k - self.delay)
        x = dead_zone(u, left, right, ratio, 1.0)
        slopes = np.array([-ratio * (u < left), -1.0 * (u > right), x * (u < left)])

        def over_a(value, past):
            return value - sum(a[i - 1] * at(past, k - i) for i in range(1, self.na + 1))

        def times(coefficients, past, first):
            return sum((c * at(past, k - i) for i, c in enumerate(coefficients, start=first)), np.zeros(3)[0])

        self.x.append(over_a(x, self.x))
        self.x_slopes.append(over_a(slopes, self.x_slopes))
        z = times(b, self.x, 0)
        self.e_slopes.append(sum(c * at(self.x_slopes, k - i) for i, c in enumerate(b)) + np.zeros(3))
        self.w.append(over_a(-z, self.w))
        self.x_d.append(self.x[k] + times(d, self.x, 1))
        self.w_d.append(self.w[k] + times(d, self.w, 1))
        by_d = sum((c * at(self.e_slopes, k - j) for j, c in enumerate(d, start=1)), self.e_slopes[k])
        foreseen = -times(d, self.v, 1)  # what the noise model expects
        v = y - offset - z
        past_v = [-at(self.v, k - j) for j in range(1, self.p + 1)]
        self.v.append(foreseen if np.isnan(v) else v)
        past_w = [at(self.w_d, k - i) for i in range(1, self.na + 1)]
        past_x = [at(self.x_d, k - i) for i in range(self.nb + 1)]
        return v - foreseen, np.array([*past_w, *past_x, 1.0 + sum(d), *by_d, *past_v])

    def learn(self, u, error, psi):
        limit = self.clip * np.sqrt(self.squares / self.weight)
        weight = min(1.0, limit / abs(error)) if error else 1.0
        self.open.append((psi, error, weight))
        self.low, self.high = min(self.low, u), max(self.high, u)
        self.squares = self.keep * self.squares + min(abs(error), limit) ** 2
        self.weight = self.keep * self.weight + 1.0
        self.v[-1] -= (1.0 - weight) * error  # an outlier is no noise that goes on

    def close(self):
        """Sum the block, let the oldest go into the reference, solve."""
        n = self.theta.size
        h = sum((w * np.outer(psi, psi) for psi, _, w in self.open), np.zeros((n, n)))
        g = sum((w * psi * error for psi, error, w in self.open), np.zeros(n))
        self.blocks.append((h, g + h @ self.theta))
        if len(self.blocks) > self.ring:
            self.reference = forgotten(*self.reference, *self.blocks.pop(0), self.tail)
        self.open, self.in_block = [], 0
        total_h, total_r = self.total()
        column = self.na + self.nb + 1
        free = [i for i in range(n) if self.offset != "zero" or i != column]
        total_h, total_r = total_h[np.ix_(free, free)], total_r[free]
        scale = np.sqrt(np.diag(total_h))
        self.theta = np.zeros(n)
        self.theta[free] = np.linalg.solve(total_h / np.outer(scale, scale), total_r / scale) / scale
        a, _, _, left, right, _, d = parts(self.theta, self.na, self.nb)
        if not (self.low <= left <= right <= self.high and largest_root(a) < 1 and largest_root(d) < 1):
            raise NotImplementedError(self.theta)
        self.follow()

    def follow(self):
        """X and v of the newest samples by the theta of now, where predictions would be clearly wrong by those held."""
        a, b, offset, left, right, log_ratio, d = parts(self.theta, self.na, self.nb)
        c = np.eye(self.theta.size)[self.na + self.nb + 3] - np.eye(self.theta.size)[self.na + self.nb + 2]
        total = self.total()[0]
        if self.offset == "zero":
            total[self.na + self.nb + 1, self.na + self.nb + 1] *= 1e9
        spread = self.squares / self.weight * (c @ np.linalg.solve(total, c))
        if (right - left) ** 2 <= np.log(max(self.weight, 2.0)) * spread:
            return
        reach = settling_time(a) + self.delay + self.nb + 1 + self.p
        if reach > self.block * len(self.blocks):
            return
        first = len(self.u) - self.block * -(-reach // self.block)
        if np.count_nonzero(np.diff(self.u[first:])) + 1 > 0.1 * (len(self.u) - first):
            return
        limit = self.clip * np.sqrt(self.squares / self.weight)
        x, v = self.x[:first], self.v[:first]

        def filtered(past, value):
            return value - sum(c * at(past, len(past) - i) for i, c in enumerate(a, start=1))

        for k in range(first, len(self.u)):
            x.append(filtered(x, dead_zone(at(self.u, k - self.delay), left, right, np.exp(log_ratio), 1.0)))
            foreseen = -sum(c * at(v, k - j) for j, c in enumerate(d, start=1))
            error = self.y[k] - offset - sum(c * at(x, k - i) for i, c in enumerate(b)) - foreseen
            weight = min(1.0, limit / abs(error)) if error and self.learned[k] else 1.0
            v.append(foreseen if np.isnan(error) else foreseen + weight * error)
        apart = [one - other for one, other in zip(x, self.x, strict=True)]
        wrong = []
        for _ in range(self.block):
            wrong.append(abs(sum(c * at(apart, len(apart) - 1 - i) for i, c in enumerate(b))))
            apart.append(filtered(apart, 0.0))
        if max(wrong) >= FELT * np.sqrt(self.squares / self.weight):
            held = max(self.na, self.nb + 1, self.p)
            self.x[-held:] = x[-held:]
            self.v[len(v) - self.p :] = v[len(v) - self.p :]

    def total(self):
        """Information and right-hand side of everything in whole blocks."""
        return sum((h for h, _ in self.blocks), self.reference[0]), sum((r for _, r in self.blocks), self.reference[1])

    @property
    def shown(self):
        """theta with the offset at zero where it explains less than BIC asks for; where asked, it is zero anyway."""
        if self.offset == "zero":
            return self.theta
        column = self.na + self.nb + 1
        offset, left, right = self.theta[column : column + 3]
        inverse = np.linalg.inv(self.total()[0])
        spread = self.squares / self.weight * inverse[column, column]
        needless = left <= 0 <= right and offset**2 < np.log(self.weight) * spread
        if self.offset == "auto" and needless:
            return self.theta - inverse[column] * offset / inverse[column, column]
        return self.theta
