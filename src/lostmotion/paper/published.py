"""What the paper prints (Cequeira et al., ICINCO 2010), and what is unclear in it."""

from __future__ import annotations

GAIN = 50.0 / 22.5

# Table 1: parameter -> (estimated, real)
TABLE_1 = {
    "a1": (-2.3271, -2.328),
    "a2": (1.8968, 1.899),
    "a3": (-0.55309, -0.5543),
    "b0": (0.00718, 0.00713),
    "b1": (0.02424, 0.02441),
    "b2": (0.00542, 0.0053),
    "right_slope": (3.0256, 3.0),
    "left_slope": (2.993, 3.0),
    "right": (1.0214, 1.0),
    "left": (-0.99561, -1.0),
}
SYMBOLS = {"right_slope": "mr", "left_slope": "ml", "right": "br", "left": "bl"}
CONVERGED_BY = 7500.0  # seconds, figure 9

# Table 2: track -> (eps1, eps2) without and with compensation; the header of the print has them exchanged
TABLE_2 = {
    1: {"without": (3.0574, 1.7683), "with": (2.4786, 0.3696)},
    2: {"without": (0.1242, 0.3722), "with": (0.0492, 0.2028)},
    3: {"without": (0.1201, 0.4188), "with": (0.0547, 0.2439)},
}

ERRATA = (
    (
        "Eq 20",
        "The instrument vector has na + nb + 1 entries, the regressor of eq 23 na + nb + 4. Here the instrument is the "
        "regressor with the measured output replaced by the model's. Filling the vector up with older inputs, the "
        "other possible reading, never converged.",
    ),
    (
        "Start",
        "theta = 10 and instruments from the first sample never converged. Here theta = 0, and plain least squares "
        "for the first 500 samples. The exponent of the initial covariance is lost in the print; 1e3 is used.",
    ),
    (
        "Eq 26",
        "b0 is the small difference of two large sums; dividing by it gives slopes of any sign in the beginning. Here "
        "its fixed-point form gain mr (1 + sum a) = b0 mr + m sum b is iterated along with the recursion.",
    ),
    (
        "Eq 30",
        "A zero-order hold and a dead time of 0.3 s give q^-4 at 0.1 s; the paper writes q^-3. The tables agree with "
        "q^-3, so the sample that the hold takes is inside its delay.",
    ),
    (
        "Table 2",
        "The columns 'with' and 'without compensation' are exchanged in the header: the text says that compensation "
        "lowers both indices on all tracks.",
    ),
    (
        "Disturbance",
        "Where the disturbance of -10 enters is not said. Through the lag of the tank at unit gain, 0.9/(s + 0.9), "
        "the published indices come out. As a step at the output or at the input of the plant, eps2 of track 1 "
        "compensated is 0.53 or 0.66 instead of 0.37, and the uncompensated loop runs away.",
    ),
    (
        "eps1, tracks 2 and 3",
        "The published control variance with compensation hangs on a few sign changes of the controller output in one "
        "run: each makes the inverse jump by br - bl. It cannot be repeated without the paper's noise sequence.",
    ),
    (
        "Large signals",
        "Without compensation the slope 3 of the valve triples the gain of the loop; with these controller settings it "
        "is unstable once the dead zone is small beside the signal. The paper's tracks stay below that.",
    ),
)
