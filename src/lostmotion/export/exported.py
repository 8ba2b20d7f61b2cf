"""export(): a block as files for one tool, with test vectors, a commissioning page, and the proof."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.gate import Said, block_behind_gate
from lostmotion.compensate.supervised import KEY_MODULUS, SupervisedBlock
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.export.commissioning import page
from lostmotion.export.dialects import TARGETS
from lostmotion.export.provenance import provenance
from lostmotion.export.replay import Replay, replay
from lostmotion.export.source import Source
from lostmotion.export.vectors import vectors
from lostmotion.files.writer import refuse_folder, write_folder
from lostmotion.identify import RatedEstimate, facts_of


@dataclass(frozen=True)
class Exported:
    """An exported block.

    Attributes
    ----------
    source : Source
        Block, name, date, arithmetic.
    target : str
        Key of ``TARGETS``.
    code : dict of str
        The file or files for the tool, by name.
    """

    source: Source
    target: str
    code: dict[str, str]

    @property
    def files(self) -> dict[str, str]:
        """Code, test vectors, commissioning page, and what a supervisor must know, by file name."""
        name = self.source.name
        return {
            **self.code,
            f"{name}_vectors.csv": vectors(self.source),
            f"{name}_commissioning.md": page(self.source, TARGETS[self.target], list(self.code)),
            **self._supervisor(),
        }

    def _supervisor(self) -> dict[str, str]:
        """The block as its supervisor must know it, where it has one: ``SupervisedBlock.from_dict``."""
        if not self.source.supervised:
            return {}
        return {f"{self.source.name}_supervisor.json": json.dumps(self.source.block.to_dict(), indent=1) + "\n"}

    def replay(self, rows: int = 10_000, seed: int = 0) -> Replay:
        """Execute the written code in plain Python over adversarial scans and compare it with the kernel."""
        return replay(self.code, self.source, rows, seed)

    def refuse(self, folder: str | os.PathLike[str], force: bool = False) -> None:
        """Raise FileAccessError where :meth:`write` could not write there."""
        place = Path(folder)
        others = ("vectors.csv", "commissioning.md", *(["supervisor.json"] if self.source.supervised else []))
        names = (*self.code, *(f"{self.source.name}_{rest}" for rest in others))
        there = [str(place / name) for name in names if os.path.lexists(place / name)]
        if there and not force:
            raise FileAccessError(f"expected new files, got {', '.join(there)}; use force=True to replace them")
        refuse_folder(place, names)

    def write(self, folder: str | os.PathLike[str], force: bool = False) -> list[Path]:
        """Write all files into a folder, or none; one that is not there is made, and appears with all of them.

        Raises
        ------
        FileAccessError
            One of them exists and `force` is not set, or cannot be written; then none is written.
        """
        self.refuse(folder, force)
        return write_folder(folder, {name: text.encode("utf-8") for name, text in self.files.items()}, force)


def export(
    block: CompensatorBlock,
    to: str = "st",
    *,
    name: str,
    date: str,
    real: str = "lreal",
    fit: RatedEstimate | Mapping[str, Any] | None = None,
    diagnosis: Said | None = None,
    accept: str | None = None,
    supervised: bool | Mapping[str, float] = False,
    origin: Mapping[str, str] | None = None,
) -> Exported:
    """Code of a block for a PLC.

    Parameters
    ----------
    block : CompensatorBlock
        The block as it was simulated, e.g. ``fit.block()``.
    to : str
        Name of a dialect out of ``TARGETS``, e.g. "st" for IEC 61131-3 Structured Text; ``TARGETS[to].title`` says
        which tools it is for.
    name : str
        Name of the function block, letters, digits and single underscores, up to 32.
    date : str
        Day of the export for the header, YYYY-MM-DD.
    real : {"lreal", "real"}
        64 or 32 bits.
    fit : HammersteinFit, FitFacts or mapping, optional
        The fit behind the settings (or its ``to_dict()``), for the header.
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop: it must name the kind that the block is for.
    accept : str, optional
        Reason for which a closed gate is passed all the same; it stands in every header. One that the block brings
        along counts too.
    supervised : bool or mapping
        The block compensates only with what a supervisor has asked for and an operator has accepted
        (``docs/supervised.md``); a mapping names settings of the supervision, in scans and units of OP.
    origin : mapping, optional
        Without a fit: "data", "fit" and "interval" of the one behind the block, in words, for the header.

    Returns
    -------
    Exported
        ``files``, ``write(folder)`` and ``replay()``.

    Raises
    ------
    GateError
        A fit that shows no such lost motion, or a diagnosis that says something else, and no reason to accept it.
    ParameterError
        An unknown target, a name or date that cannot be used, settings that do not fit the types.

    Examples
    --------
    >>> block = CompensatorBlock.of("backlash", 0.5, {"lead_up": 0.5, "lead_down": 0.5, "band": 0.1})
    >>> done = export(block, "st", name="FY_101", date="2026-01-31")
    >>> list(done.files)
    ['FY_101.st', 'FY_101_vectors.csv', 'FY_101_commissioning.md']
    >>> done.replay(rows=200).agrees
    True
    """
    if to not in TARGETS:
        raise ParameterError.expected(f"to out of {list(TARGETS)}", repr(to), "choose one of them")
    facts = None if fit is None else facts_of(fit)
    block = block_behind_gate(block, facts, diagnosis, accept)
    exported = block if supervised is False else supervised_block(block, name, supervised)
    source = Source(exported, name, date, real, **((origin or {}) if facts is None else provenance(facts)))
    return Exported(source, to, TARGETS[to].files(source))


def supervised_block(block: CompensatorBlock, name: str, settings: bool | Mapping[str, float]) -> SupervisedBlock:
    """The block under supervision; its key, where it is not given, comes from its name in the PLC."""
    given = {} if isinstance(settings, bool) else dict(settings)
    return SupervisedBlock.of(block, **{"block_key": float(zlib.crc32(name.encode()) % KEY_MODULUS), **given})
