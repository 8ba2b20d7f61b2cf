"""The block of a study on valves of the other kinds that explain the record as well; a smaller share where it harms.

Backlash is believed before the stiction that is as likely, as it is simpler; its inverse is not as harmless.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from lostmotion.compensate import CompensatorBlock
from lostmotion.errors import InputError
from lostmotion.evaluate.study import CompensationStudy
from lostmotion.evaluate.study.trial import SHARES
from lostmotion.simulate import PI

OnKind = Callable[[str, CompensatorBlock, PI | None], CompensationStudy]


@dataclass(frozen=True)
class Rivals:
    """Kinds that are as likely as the one fitted.

    Attributes
    ----------
    kinds : sequence of str
    on : callable
        Study of a given block, with a given controller, on a valve of a kind; InputError where it cannot be simulated,
        which shows no harm.
    """

    kinds: Sequence[str]
    on: OnKind

    def harmed(self, block: CompensatorBlock, controller: PI | None) -> str:
        """The first kind on which the block does harm with the controller, or is empty."""
        return next((kind for kind in self.kinds if not self._safe(kind, block, controller)), "")

    def safest(
        self, study: CompensationStudy, controller: PI | None, smaller: Callable[[float], CompensationStudy]
    ) -> tuple[CompensationStudy, str]:
        """The study of the largest share that is safe on all kinds and helps, and the kind harmed where there is none.

        `smaller` makes the study of a share of the lost motion.
        """
        harmed = self.harmed(study.block, controller)
        if not harmed:
            return study, ""
        whole = study.block.settings["factor"]
        for share in SHARES:
            other = smaller(share * whole)
            if other.safe and other.useful and not self.harmed(other.block, controller):
                return _noted(other, share * whole, whole, harmed), ""
        return study, harmed

    def _safe(self, kind: str, block: CompensatorBlock, controller: PI | None) -> bool:
        try:
            return self.on(kind, block, controller).safe
        except InputError:
            return True


def _noted(study: CompensationStudy, factor: float, whole: float, kind: str) -> CompensationStudy:
    """With what is compensated less, and why, in its words and in the block."""
    said = (
        f"The block compensates {100.0 * factor:.0f} % of the lost motion: {kind} explains the record as well, and on"
        f" such a valve one of {100.0 * whole:.0f} % would not be safe."
    )
    note = f"factor {factor:.3f}: a larger share was not safe on a valve with {kind}, which is as likely"
    reasons, brief = ((first, said, *others) for first, *others in (study.reasons, study.brief))
    block = replace(study.block, notes=(*study.block.notes, note))
    return replace(study, reasons=reasons, brief=brief, block=block)
