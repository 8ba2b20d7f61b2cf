"""What every refusal of an input must look like."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from lostmotion.errors import InputError


def refusal(kind: type[InputError], call: Callable[..., Any], *args: Any, **options: Any) -> str:
    """Message of the refusal: of this class, "expected X, got Y; do Z" on one line."""
    with pytest.raises(kind) as caught:
        call(*args, **options)
    message = str(caught.value)
    assert message.startswith("expected ")
    assert ", got " in message
    assert "; " in message.split(", got ", 1)[1]
    assert "\n" not in message
    return message
