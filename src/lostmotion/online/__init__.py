"""Estimation beside the plant: rows come in, reports and events go out, and everything can be stopped and gone on."""

from lostmotion.online.monitor import OnlineMonitor
from lostmotion.online.trend import Line, Reach, Trend

__all__ = ["Line", "OnlineMonitor", "Reach", "Trend"]
