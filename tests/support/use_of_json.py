"""What is done with a fit or a block from a file, short of a study: read, print, write, make the block."""

import json

from lostmotion.compensate import CompensatorBlock, read_block, read_fit_or_block
from lostmotion.errors import LostMotionError
from lostmotion.identify import read_fit


def use(path):
    """Read a file by every door that takes it, and use what comes out."""
    found = read_fit_or_block(path)
    if isinstance(found, CompensatorBlock):
        block = read_block(path)
        assert block == found
    else:
        fit = read_fit(path)
        fit.summary()
        json.dumps(fit.to_dict(), allow_nan=False)
        block = fit.block(span=(-100.0, 100.0))
    json.dumps(block.to_dict(), allow_nan=False)
    return block


def outcome(path):
    try:
        use(path)
    except LostMotionError as error:
        return f"refused {type(error).__name__}" + (" MANY LINES" if "\n" in str(error) else "")
    except Exception as error:  # noqa: BLE001  it is what is sought
        return f"TRACEBACK {type(error).__name__} {str(error)[:100]!r}"
    return "works"
