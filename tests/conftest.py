"""Hypothesis: the same examples in every CI run, new ones at the desk."""

import os

from hypothesis import settings

collect_ignore = ["plc/build.py", "plc/parse.py"]  # run by the Python of .venv-plc

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("desk", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "desk")
