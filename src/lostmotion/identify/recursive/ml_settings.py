"""Settings of RecursiveML, checked, and what the kernel is tuned with by them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lostmotion.arguments import finite, positive, whole
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.distributions import normal_quantile
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.dead_zone import LARGEST_SLOPE_RATIO
from lostmotion.kernels.recursive_ml import state as ml

BLOCK, LARGEST_RING = 64, 16  # samples and blocks: some 1,000 samples are stored, as many as a first window
SMALLEST_BLOCK = 4
FEWEST_BLOCKS = 8  # of the ring, where one forgets: the test looks at windows of 1, 2, 4 and 8
LEAST_FORGETTING = 0.95  # a memory of 20 samples; less does not hold the parameters
MOST_ALARMS = 0.01  # per sample: more are no alarms
OFFSETS = {"auto": 0.0, "free": np.nan, "zero": 1.0}  # as the kernel has them
DIRECTIONS = 3  # that are tested: left, right, gain


@dataclass(frozen=True)
class Tuning:
    """How the recursion forgets, bounds and tests."""

    forgetting: float
    clip: float
    threshold: float
    offset: str

    @property
    def memory(self) -> tuple[int, int, float]:
        """Samples of a block, blocks of the ring, and what the reference forgets per block.

        The memory of 1 / (1 - forgetting) samples is shared by the ring, at most half of it, and the reference.
        """
        if self.forgetting == 1.0:
            return BLOCK, LARGEST_RING, 0.0
        memory = 1.0 / (1.0 - self.forgetting)
        ring = min(0.5 * memory, BLOCK * LARGEST_RING)
        block = int(np.clip(ring / FEWEST_BLOCKS, SMALLEST_BLOCK, BLOCK))
        blocks = max(int(ring / block), 2)
        return block, blocks, float(1.0 - (1.0 - 1.0 / (memory - block * blocks)) ** block)

    def places(self, orders: tuple[int, int, int], noise_order: int) -> ml.Places:
        """All that the sizes of the state depend on."""
        block, ring, _ = self.memory
        return ml.Places(*orders, noise_order, block, ring)

    def allocate(self, orders: tuple[int, int, int], noise_order: int) -> tuple[FloatArray, IntArray]:
        """Empty state of the kernel and its layout."""
        block, ring, tail = self.memory
        state, layout = ml.lay_out(self.places(orders, noise_order))
        state[[ml.TAIL, ml.KEEP, ml.CLIP, ml.THRESHOLD]] = tail, self.forgetting, self.clip, self.threshold
        state[ml.ZERO] = OFFSETS[self.offset]
        state[ml.RATIO_LIMIT] = np.log(LARGEST_SLOPE_RATIO)
        layout[ml.TEST_AFTER] = block * ring // 2
        return state, layout


@dataclass(frozen=True)
class Settings:
    """Arguments of RecursiveML, see there; ParameterError where they are none.

    The fields are those of the header of its bytes, in their order.
    """

    na: int
    nb: int
    delay: int
    gain: float | None
    forgetting: float
    dt: float
    noise: str | int
    offset: str
    start_samples: int
    outliers: float | None
    false_alarms: float | None

    def __post_init__(self) -> None:
        for name in ("na", "nb", "delay"):
            self._take(name, whole(name, getattr(self, name), 0))
        if not LEAST_FORGETTING < finite("forgetting", self.forgetting) <= 1:
            expected = f"forgetting in ({LEAST_FORGETTING}, 1]"
            raise ParameterError.expected(expected, self.forgetting, "0.999 remembers 1,000 samples")
        self._take("forgetting", float(self.forgetting))
        for name in ("gain", "outliers", "false_alarms"):
            value = getattr(self, name)
            self._take(name, None if value is None else finite(name, value))
        if self.gain == 0:
            raise ParameterError.expected("a gain other than 0", self.gain, "give y per x at rest, or None")
        self._check_choices()
        self._check_start()
        self._check_tests()
        self._take("dt", positive("dt", self.dt))

    def _take(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_choices(self) -> None:
        if not isinstance(self.offset, str) or self.offset not in OFFSETS:
            expected = 'offset as "auto", "free" or "zero"'
            raise ParameterError.expected(expected, repr(self.offset), "choose one of them")
        if not (isinstance(self.noise, str) and self.noise in ("auto", "white")):
            self._take("noise", whole('noise (or "auto", "white")', self.noise, 0))

    def _check_start(self) -> None:
        fewest = 4 * (self.na + self.nb + self.delay) + 60  # four samples a parameter; fewer fit anything
        start_samples = whole("start_samples", self.start_samples, 1)
        if start_samples < fewest:
            expected = f"start_samples >= {fewest} for these orders"
            raise ParameterError.expected(expected, start_samples, "1000 is usual")
        self._take("start_samples", start_samples)

    def _check_tests(self) -> None:
        if self.outliers is not None and self.outliers <= 1:
            expected = "outliers > 1 (standard deviations) or None"
            raise ParameterError.expected(expected, self.outliers, "4 is usual")
        if self.false_alarms is not None and not 0 < self.false_alarms < MOST_ALARMS:
            expected = f"false_alarms in (0, {MOST_ALARMS}) per sample, or None"
            raise ParameterError.expected(expected, self.false_alarms, "e.g. 1e-9")

    @property
    def orders(self) -> tuple[int, int, int]:
        """Na, nb and delay."""
        return self.na, self.nb, self.delay

    @property
    def tuning(self) -> Tuning:
        """What the kernel is tuned with; without a test for changes its threshold is infinite."""
        clip = np.inf if self.outliers is None else self.outliers
        tuning = Tuning(self.forgetting, clip, np.inf, self.offset)
        if self.false_alarms is None:
            return tuning
        block, ring, _ = tuning.memory
        tests = DIRECTIONS * (int(math.log2(ring)) + 1)  # Bonferroni over directions and windows of one block
        threshold = -normal_quantile(0.5 * self.false_alarms * block / tests)
        return Tuning(self.forgetting, clip, threshold, self.offset)

    @property
    def remembered(self) -> float:
        """Samples that the memory holds, where there have been so many; 1e12 where nothing is forgotten."""
        return 1.0 / max(1.0 - self.forgetting, 1e-12)
