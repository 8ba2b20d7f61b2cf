"""A loop list for ``lostmotion audit --propose DATA > loops.csv``."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def propose(source: Path | list[Path] | Any, **reading: Any) -> str:
    """Text of a loop list: names, ISA-5.1 letters and the data say what they can, a person corrects it.

    Parameters
    ----------
    source : path, list of paths, or anything that :func:`lostmotion.plant.open_plant` takes
    **reading
        Settings for all loops alike.

    Raises
    ------
    LostMotionError
        As in open_plant; or there is no loop at all.
    """
    from lostmotion.cli.progress import progress
    from lostmotion.errors import DataError
    from lostmotion.plant import loop_list_text, open_plant
    from lostmotion.plant import propose as proposed

    plant = open_plant(source, **reading)
    loops = proposed(plant, lambda done, total: progress(f"{done} of {total} loops looked at"))
    progress("")
    if not loops:
        why = next((f"{one.where}: {one.why}" for one in plant.unread() if one.failed), "no file with OP and PV")
        raise DataError.expected("data of at least one loop", f"none ({why})", "name OP and PV in a loop list")
    return loop_list_text(loops)
