"""Plant file and supervised block of the virtual plant, to try `live --write` and `request` with."""

from __future__ import annotations

import json
from pathlib import Path

from lostmotion.errors import FileAccessError
from lostmotion.files.writer import write_together
from lostmotion.live.virtual_plant import VirtualLoop

PLANT, BLOCK, LOG, REQUESTS = "plant.toml", "ty103_supervisor.json", "requests.jsonl", "requests"
OWN_FOLDER = 0o700
TEXT = """\
# The bench of `lostmotion demo-live`: one loop that may be asked for other widths, where --write is said as well.
address = "{address}"

[supervision]
log = "{log}"            # a line for everything that is asked of a PLC
requests = "{requests}"             # the door of `lostmotion request`

[[loop]]
tag = "TIC103"
op = "ns=2;s=TY103.OP_OUT"        # what goes to the valve, behind the block
pv = "ns=2;s=TIC103.PV"
mode = "ns=2;s=TIC103.MODE"
orders = [1, 0, 1]
noise = 6
dt = {dt!r}
start_samples = 600
report_every = 100

[loop.block]
file = "{block}"
nodes = "ns=2;s=TY103."
name = "TY103"
write = true
adaptive = true
who = "estimate of TIC103"
least_interval = {interval!r}
least_change = 0.1
kp = {kp!r}
ki = {ki!r}
sp_step = {swing!r}
hold = {hold!r}
"""


def demo_files(folder: Path, address: str, loop: VirtualLoop, period: float) -> Path:
    """Write them into a folder that is new or empty; gives the plant file.

    Parameters
    ----------
    folder : Path
    address : str
        Of the server.
    loop : VirtualLoop
        With a dead zone.
    period : float
        Seconds of the clock between two scans: all times of the files are of the clock.

    Raises
    ------
    FileAccessError
        There are files in the folder, or it cannot be written.
    """
    speed = loop.scan_time / period
    text = TEXT.format(
        address=address, log=LOG, requests=REQUESTS, dt=period, block=BLOCK, interval=60.0 / speed, kp=loop.kp,
        ki=loop.ki * speed, swing=loop.swing, hold=loop.swing_seconds / speed,
    )  # fmt: skip
    block = {**loop.block.to_dict(), "scan_time": period}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / REQUESTS).mkdir(mode=OWN_FOLDER)
    except OSError as error:
        raise FileAccessError(f"expected a new folder, got {folder}: {error.strerror}; choose another") from error
    write_together({folder / PLANT: text.encode(), folder / BLOCK: (json.dumps(block, indent=2) + "\n").encode()})
    return folder / PLANT
