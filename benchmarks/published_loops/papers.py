"""The papers, by the name that plants have; and those of the valves alone."""

from __future__ import annotations

CEP, JPC, IECR = "Control Engineering Practice", "Journal of Process Control", "Ind. Eng. Chem. Res."
OF_NO_PAPER = ("dead zone, of no paper", "drift, of no paper")
PAPERS = {
    "Karnopp 1985": "Computer simulation of stick-slip friction in mechanical dynamic systems, J. Dyn. Syst. Meas. "
    "Control 107",
    "Hägglund 1995": f"A control-loop performance monitor, {CEP} 3",
    "Canudas de Wit et al. 1995": "A new model for control of systems with friction, IEEE Trans. Autom. Control 40",
    "Tao and Kokotovic 1996": "Adaptive Control of Systems with Actuator and Sensor Nonlinearities, Wiley",
    "Horch 1999": f"A simple method for detection of stiction in control valves, {CEP} 7",
    "Kayihan and Doyle 2000": f"Friction compensation for a process control valve, {CEP} 8",
    "Nordin and Gutman 2002": "Controlling mechanical systems with backlash: a survey, Automatica 38",
    "Stenman et al. 2003": "A segmentation-based method for detection of stiction in control valves, Int. J. Adapt. "
    "Control Signal Process. 17",
    "Choudhury et al. 2004": "Diagnosis of poor control-loop performance using higher-order statistics, Automatica 40",
    "Kano et al. 2004": "Practical model and detection algorithm for valve stiction, IFAC DYCOPS",
    "Choudhury et al. 2005": f"Modelling valve stiction, {CEP} 13",
    "Rossi and Scali 2005": "A comparison of techniques for automatic detection of stiction: simulation and "
    f"application to industrial data, {JPC} 15",
    "Singhal and Salsbury 2005": f"A simple method for detecting valve stiction in oscillating control loops, {JPC} 15",
    "Srinivasan et al. 2005": "Control loop performance assessment. 2. Hammerstein model approach for stiction "
    f"diagnosis, {IECR} 44",
    "Hägglund 2007": f"Automatic on-line estimation of backlash in control loops, {JPC} 17",
    "He et al. 2007": f"A curve fitting method for detecting valve stiction in oscillating control loops, {IECR} 46",
    "Thornhill and Horch 2007": "Advances and new directions in plant-wide disturbance detection and diagnosis, "
    f"{CEP} 15",
    "Chen et al. 2008": f"Two-layer binary tree data-driven model for valve stiction, {IECR} 47",
    "Garcia 2008": f"Comparison of friction models applied to a control valve, {CEP} 16",
    "Jelali 2008": "Estimation of valve stiction in control loops using separable least-squares and global search "
    f"algorithms, {JPC} 18",
    "Lee et al. 2008": "Novel closed-loop stiction detection and quantification method via system identification, "
    "ADCONIP",
    "Karra and Karim 2009": "Comprehensive methodology for detection and diagnosis of oscillatory control loops, "
    f"{CEP} 17",
    "Zabiri and Ramasamy 2009": f"NLPCA as a diagnostic tool for control valve stiction, {JPC} 19",
    "Selvanathan and Tangirala 2010": "author and year alone",
    "Romano and Garcia 2011": f"Valve friction and nonlinear process model closed-loop identification, {JPC} 21",
    "Farenzena and Trierweiler 2012": f"Valve stiction estimation using global optimisation, {CEP} 20",
    "Bacci di Capaci and Scali 2014": "Stiction quantification: a robust methodology for valve monitoring and "
    f"maintenance scheduling, {IECR} 53",
    "Fang and Wang 2015": "Identification of Hammerstein systems using Preisach model for sticky control valves, "
    f"{IECR} 54",
}


def references() -> list[str]:
    """A line for each paper."""
    return [f"- {name}: {title}" for name, title in PAPERS.items()]
