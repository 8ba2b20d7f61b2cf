"""lostmotion finds the lost motion of industrial actuators in the records of their control loops.

The main job in one line: record -> identify -> compensate -> simulate -> export.

>>> import lostmotion as lm
>>> valve = lm.DeadZone(left=-1.0, right=1.0, left_slope=3.0, right_slope=3.0)
>>> valve(2.0)
3.0

What the package offers stands in ``__init__.pyi``; each name is loaded when it is first used.
"""

from typing import Any

import lazy_loader

from lostmotion.extras import extra as _extra
from lostmotion.working_folder import ignore_numba_settings as _ignore_numba_settings

__version__ = "0.1.0"

_ROOMS = (
    "compensate",
    "datasets",
    "evaluate",
    "export",
    "files",
    "models",
    "online",
    "plot",
    "records",
    "report",
    "simulate",
)

_ignore_numba_settings()
_attribute, _, _names = lazy_loader.attach_stub(__name__, __file__)
__all__ = [name for name in _names if name not in _ROOMS]


def __getattr__(name: str) -> Any:
    with _extra():  # `audit` needs packages of an extra
        return _attribute(name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_names})
