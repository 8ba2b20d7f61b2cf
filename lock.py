"""Write locked.txt: the pins of constraints.txt with the digests of their files, for ``pip install --require-hashes``.

Run: ``.venv/bin/python lock.py``. The index is that of pip; no address goes into the file. Files of older Pythons are
left out; all systems and machines are in.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import urllib.request
from pathlib import Path

from packaging.utils import InvalidWheelFilename, parse_wheel_filename
from pip._internal.models.index import PyPI

ROOT = Path(__file__).parent
PINS, LOCKED = ROOT / "constraints.txt", ROOT / "locked.txt"
HEAD = "# Pins of constraints.txt with the digests of their files; made by lock.py.\n"
OLDEST = 11  # of Python 3: pyproject.toml
TIMEOUT = 60  # s
LINK = re.compile(r'#sha256=([0-9a-f]{64})"[^>]*>\s*([^<\s]+)\s*</a>')
JSON = "application/vnd.pypi.simple.v1+json"


def index() -> str:
    """Address of the index of packages."""
    asked = [sys.executable, "-m", "pip", "config", "get", "global.index-url"]
    told = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()  # noqa: S603  fixed words
    return (os.environ.get("PIP_INDEX_URL") or told or PyPI.simple_url).rstrip("/")


def digests(address: str, name: str, version: str) -> list[str]:
    """SHA-256 of the files of one version, sorted.

    Raises
    ------
    OSError
        The index has none.
    """
    page = urllib.request.Request(f"{address}/{name}/", headers={"Accept": f"{JSON}, text/html;q=0.1"})  # noqa: S310
    with urllib.request.urlopen(page, timeout=TIMEOUT) as answer:  # noqa: S310  an address of the user's
        text = answer.read().decode()
        if "json" in answer.headers.get_content_type():
            files = {one["filename"]: one["hashes"].get("sha256", "") for one in json.loads(text)["files"]}
        else:
            files = {file: digest for digest, file in LINK.findall(text)}
    found = sorted({digest for file, digest in files.items() if digest and wanted(file, version)})
    if not found:
        raise OSError(f"expected files of {name} {version} with digests, got none; is the pin right?")
    return found


def wanted(file: str, version: str) -> bool:
    """Whether a file is of this version, and for a Python that can run it here."""
    if file.endswith((".tar.gz", ".zip")):
        return file.removesuffix(".tar.gz").removesuffix(".zip").rpartition("-")[2] == version
    try:
        _, found, _, tags = parse_wheel_filename(file)
    except InvalidWheelFilename:
        return False
    pythons = {tag.interpreter for tag in tags}
    return str(found) == version and any(_new_enough(python, {tag.abi for tag in tags}) for python in pythons)


def _new_enough(python: str, abis: set[str]) -> bool:
    minor = re.fullmatch(r"cp3(\d+)", python)
    return python in ("py3", "py2.py3") or (minor is not None and ("abi3" in abis or int(minor[1]) >= OLDEST))


def main() -> None:
    """All pins, in the order of constraints.txt."""
    address, lines = index(), [HEAD]
    for pin in PINS.read_text(encoding="utf-8").splitlines():
        if pin.startswith("#"):
            continue
        name, version = pin.split("==")
        lines.append(" ".join([pin, *(f"--hash=sha256:{one}" for one in digests(address, name, version))]) + "\n")
    LOCKED.write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
