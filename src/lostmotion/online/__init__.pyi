from .monitor import OnlineMonitor
from .trend import Line, Reach, Trend

__all__ = ["Line", "OnlineMonitor", "Reach", "Trend"]
