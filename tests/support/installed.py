"""A wheel of this tree, installed into environments of its own: plain, and with one extra each."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.support.places import ROOT

BUILT_FROM = ("pyproject.toml", "setup.py", "fetch_uplot.py", "MANIFEST.in", "README.md", "LICENSE", "src")
NOT_COPIED = shutil.ignore_patterns("__pycache__", "*.egg-info", "vendor")
TIMEOUT = 600  # s: for one installation or one command


class Environment:
    """A virtual environment with its own home: nothing of the tests is on its path."""

    def __init__(self, folder: Path, home: Path, beside: Environment | None = None) -> None:
        """Make it; `beside` another one it has that one's packages too, without a copy of them."""
        self.folder, self.home = folder, home
        pip = () if beside is None else ("--without-pip",)
        subprocess.run([sys.executable, "-m", "venv", *pip, str(folder)], check=True, timeout=TIMEOUT)
        self.python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
        self.site = Path(self.run("-c", "import sysconfig; print(sysconfig.get_path('purelib'))").stdout.strip())
        self._pip = self.python if beside is None else beside.python
        if beside is not None:
            (self.site / "plain.pth").write_text(f"{beside.site}\n", encoding="utf-8")

    def install(self, *what: str) -> None:
        """With the pinned versions."""
        words = ["-m", "pip", "--python", str(self.python), "install", "-q", "--disable-pip-version-check"]
        pins = ["-c", str(ROOT / "constraints.txt")]
        subprocess.run(
            [str(self._pip), *words, *pins, *what], check=True, timeout=TIMEOUT, capture_output=True, text=True
        )

    def run(self, *words: str, cwd: Path | None = None, given: str = "") -> subprocess.CompletedProcess[str]:
        """Its Python with these words, and a text on standard input."""
        wanted = ("PATH", "SYSTEMROOT", "TEMP", "TMP", "LANG", "OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
        own = {name: os.environ[name] for name in wanted if name in os.environ}
        own |= {"HOME": str(self.home), "XDG_CACHE_HOME": str(self.home / "cache"), "LOCALAPPDATA": str(self.home)}
        return subprocess.run(
            [str(self.python), *map(str, words)], env=own, cwd=cwd or self.home, input=given,
            capture_output=True, text=True,
            timeout=TIMEOUT, check=False,
        )  # fmt: skip

    def command(self, *words: object, cwd: Path | None = None, given: str = "") -> subprocess.CompletedProcess[str]:
        """``lostmotion`` with these words."""
        return self.run("-m", "lostmotion", *map(str, words), cwd=cwd, given=given)


def build_wheel(folder: Path) -> Path:
    """Wheel of a copy of this tree, as somebody else would build it."""
    copy = folder / "source"
    copy.mkdir(parents=True)
    for name in BUILT_FROM:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, copy / name, ignore=NOT_COPIED)
        else:
            shutil.copy(source, copy / name)
    words = ["-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-deps", "-w", str(folder), str(copy)]
    subprocess.run([sys.executable, *words], check=True, timeout=TIMEOUT, capture_output=True, text=True)
    (wheel,) = folder.glob("*.whl")
    return wheel
