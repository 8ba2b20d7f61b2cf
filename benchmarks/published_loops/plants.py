"""Processes under the controllers of the papers, by name.

Written from memory of the papers: models and their parameters are in the papers' range, those of Choudhury 2004 and
2005, Kano 2004, Jelali 2008 and the valve of Kayihan and Doyle 2000 as they are there. Where a paper has industrial
records or a range of processes, a process of that kind stands for it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from published_loops.process import Process, integrating, lags, response

FREQUENCIES = np.linspace(1e-4, np.pi, 40_000)[:-1]  # rad/row


@dataclass(frozen=True)
class Plant:
    """A process under a PI controller.

    Attributes
    ----------
    paper : str
        Author and year.
    process : Process
    gain : float
        Of the controller, % of OP for each % of PV.
    reset : float
        Reset time, s.
    seconds : float
        Of a row; the controller scans once a row.
    """

    paper: str
    process: Process
    gain: float
    reset: float
    seconds: float = 1.0

    def scaled(self, factor: float) -> Plant:
        """With so many times the gain and the same reset time."""
        return replace(self, gain=self.gain * factor)

    def near_its_limit(self, share: float) -> Plant:
        """With this share of the gain at which it would ring for ever."""
        return self.scaled(share * ultimate_factor(self))

    def tuned(self, gain: float, reset: float) -> Plant:
        """Under another controller."""
        return replace(self, gain=gain, reset=reset)


def ultimate_factor(plant: Plant) -> float:
    """How many times the gain of the controller can be until the loop, as it is sampled, rings for ever."""
    z = np.exp(1j * FREQUENCIES)
    integral = plant.seconds / plant.reset * z / (z - 1)
    open_loop = plant.gain * (1 + integral) * response(plant.process.state_space(plant.seconds), FREQUENCIES)
    crossing = np.flatnonzero((open_loop.imag[:-1] < 0) & (open_loop.imag[1:] >= 0) & (open_loop.real[1:] < 0))
    return float(1 / np.abs(open_loop[crossing + 1]).max())


CHOUDHURY_2004 = Process((1.45, -1.0), (1.0, -0.8), 2, sampled=True)  # and the row of the controller: z^-3
PLANTS = {
    "hagglund95": Plant("Hägglund 1995", lags(1, 1, 1, 1), 0.8, 2.4, 0.3),
    "horch99-flow": Plant("Horch 1999", lags(1, 3, dead_time=1), 0.4, 2.5, 0.5),
    "horch99-flow-slave": Plant("Horch 1999", lags(1, 3, dead_time=1), 0.6, 3.0),
    "horch99-level": Plant("Horch 1999", integrating(0.05, 2), 2.0, 30.0),
    "nordin02-servo": Plant("Nordin and Gutman 2002", Process((1.0,), (0.5, 1.0, 0.0)), 0.8, 4.0, 0.1),
    "stenman03": Plant("Stenman et al. 2003", lags(1, 10, dead_time=2), 1.2, 10.0),
    "choudhury04": Plant("Choudhury et al. 2004", CHOUDHURY_2004, 0.15, 1.0),
    "kano04-flow": Plant("Kano et al. 2004", lags(1, 0.2), 0.5, 0.3, 0.1),
    "kano04-flow-1s": Plant("Kano et al. 2004", lags(1, 0.2), 0.15, 0.5),
    "kano04-level": Plant("Kano et al. 2004", Process((1.0,), (15.0, 0.0)), 3.0, 30.0),
    "choudhury05-concentration": Plant("Choudhury et al. 2005", lags(3, 10, dead_time=10), 0.2, 10.0),
    "choudhury05-level": Plant("Choudhury et al. 2005", integrating(1), 0.4, 2.0),
    "rossi05-lag": Plant("Rossi and Scali 2005", lags(1, 10, dead_time=1), 4.0, 4.0, 0.25),
    "rossi05-equal": Plant("Rossi and Scali 2005", lags(1, 10, dead_time=10), 0.8, 15.0),
    "rossi05-delay": Plant("Rossi and Scali 2005", lags(1, 2, dead_time=10), 0.3, 5.0),
    "singhal05": Plant("Singhal and Salsbury 2005", lags(1, 100, dead_time=30), 1.2, 100.0, 10.0),
    "srinivasan05": Plant("Srinivasan et al. 2005", lags(2, 5, dead_time=1), 0.5, 5.0, 0.5),
    "hagglund07-lag": Plant("Hägglund 2007", lags(1, 10, dead_time=3), 1.0, 10.0),
    "hagglund07-lags": Plant("Hägglund 2007", lags(1, 4, 4, 4, dead_time=1), 0.8, 10.0),
    "hagglund07-level": Plant("Hägglund 2007", integrating(0.02, 2), 4.0, 50.0),
    "he07-lag": Plant("He et al. 2007", lags(1.5, 8, dead_time=3), 0.7, 8.0),
    "he07-lag-tight": Plant("He et al. 2007", lags(1.5, 8, dead_time=3), 0.9, 6.0),
    "he07-level": Plant("He et al. 2007", integrating(0.05, 2), 2.5, 40.0),
    "thornhill07-flow": Plant("Thornhill and Horch 2007", lags(0.8, 4, dead_time=4), 0.4, 6.0, 2.0),
    "garcia08-lag": Plant("Garcia 2008", lags(1, 6, dead_time=2), 0.8, 6.0),
    "garcia08-lag-tight": Plant("Garcia 2008", lags(1, 6, dead_time=2), 1.2, 5.0),
    "garcia08-slow": Plant("Garcia 2008", lags(1, 40, dead_time=10), 2.0, 35.0, 5.0),
    "garcia08-level": Plant("Garcia 2008", integrating(0.05, 1), 2.5, 40.0),
    "jelali08-flow": Plant("Jelali 2008", lags(1, 0.2, dead_time=0.2), 0.3, 0.3, 0.1),
    "jelali08-level": Plant("Jelali 2008", Process((1.0,), (15.0, 0.0), 2.0), 3.0, 30.0),
    "lee08": Plant("Lee et al. 2008", lags(1, 10, 2, dead_time=2), 1.5, 10.0),
    "karra09": Plant("Karra and Karim 2009", CHOUDHURY_2004, 0.12, 1.0),
    "zabiri09": Plant("Zabiri and Ramasamy 2009", lags(1.54, 5.93, dead_time=1.07), 1.0, 5.0, 0.5),
    "zabiri09-tight": Plant("Zabiri and Ramasamy 2009", lags(1.54, 5.93, dead_time=1.07), 1.5, 3.0, 0.5),
    "selvanathan10-lag": Plant("Selvanathan and Tangirala 2010", lags(1, 20, dead_time=5), 2.5, 10.0),
    "selvanathan10-level": Plant("Selvanathan and Tangirala 2010", integrating(0.1, 3), 1.0, 20.0),
    "romano11": Plant("Romano and Garcia 2011", lags(1, 5, dead_time=2, bend=0.02), 0.7, 5.0),
    "romano11-bent": Plant("Romano and Garcia 2011", lags(1, 5, dead_time=2, bend=0.04), 0.5, 5.0),
    "farenzena12": Plant("Farenzena and Trierweiler 2012", integrating(0.05, 1), 2.0, 50.0),
    "bacci14": Plant("Bacci di Capaci and Scali 2014", lags(2, 12, 4, dead_time=3), 0.8, 14.0),
    "fang15": Plant("Fang and Wang 2015", lags(1.2, 15, dead_time=4), 1.2, 14.0),
    "zone-level": Plant("dead zone, of no paper", integrating(0.05, 1), 2.0, 25.0),
    "zone-lag": Plant("dead zone, of no paper", lags(1, 8, dead_time=3), 1.0, 8.0),
    "zone-lag-tight": Plant("dead zone, of no paper", lags(1.5, 10, dead_time=4), 1.0, 6.0),
    "drifting-lag": Plant("drift, of no paper", lags(1, 20, dead_time=5), 0.4, 25.0),
}


def slower(plant: Plant, times: float) -> Plant:
    """All times longer, of the row too."""
    longer = plant.process.slower(times)
    return replace(plant, process=longer, reset=plant.reset * times, seconds=plant.seconds * times)


PLANTS |= {f"{name}-5s": slower(PLANTS[name], 5) for name in ("he07-lag-tight", "choudhury04", "garcia08-lag-tight")}
