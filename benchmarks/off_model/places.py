"""Where the real records lie; a worker process takes the folder from its environment."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "OFF_MODEL_ACTUATORS"
ACTUATORS = Path(os.environ.get(VARIABLE, Path(__file__).resolve().parents[2].parent / "shared" / "actuators"))
