"""Build: the files that the page draws trends with are fetched into the package where they are not there yet."""

from __future__ import annotations

import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent
sys.path.insert(0, str(ROOT))

from fetch_uplot import fetch_uplot  # noqa: E402  the build runs outside of this folder

VENDOR = ROOT / "src/lostmotion/web/static/vendor"


class BuildWithUPlot(build_py):
    """Copy the package, with uPlot."""

    def run(self) -> None:
        """Fetch what is missing; a build without npm goes on without it."""
        if not self.editable_mode and not (VENDOR / "uPlot.iife.min.js").is_file():
            try:
                fetch_uplot(VENDOR)
            except OSError as error:
                self.warn(f"{error}. The page of this build draws trends as SVG.")
        super().run()


setup(cmdclass={"build_py": BuildWithUPlot})
