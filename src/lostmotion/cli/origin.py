"""A block as JSON, with what its fit says of where the settings come from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lostmotion.compensate import CompensatorBlock
    from lostmotion.identify import RatedEstimate


def saved_block(block: CompensatorBlock, fit: RatedEstimate | None, file: Path | None = None) -> dict[str, Any]:
    """The dictionary of a block for its file; `file` is that of the block, where it was read."""
    from lostmotion.compensate.saved_block import read_origin
    from lostmotion.export.provenance import provenance
    from lostmotion.identify import facts_of

    origin = provenance(facts_of(fit)) if fit is not None else {} if file is None else read_origin(file)
    return block.to_dict() | ({"origin": origin} if origin else {})
