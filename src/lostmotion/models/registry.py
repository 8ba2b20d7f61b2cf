"""Which kinds of actuator there are, by the name under which they write themselves."""

from __future__ import annotations

from typing import Any, TypeVar

from lostmotion.errors import ParameterError
from lostmotion.models.hammerstein import Nonlinearity

Model = TypeVar("Model", bound=type[Any])
NEEDED = ("kind", "own", "size_name", "from_dict")

_MODELS: dict[str, Any] = {}


def actuator(model: Model) -> Model:
    """Make a model class known by its kind; to be written above the class.

    Raises
    ------
    ParameterError
        It does not say its kind, its parameters, or which of them is its size; or the kind is taken.
    """
    missing = [name for name in NEEDED if not hasattr(model, name)]
    if missing:
        raise ParameterError.expected(f"a model with {list(NEEDED)}", f"{model.__name__} without {missing}", "add them")
    kind: str = getattr(model, "kind")  # noqa: B009  the type checker does not know that it is there
    taken = _MODELS.get(kind)
    if taken is not None and (taken.__module__, taken.__qualname__) != (model.__module__, model.__qualname__):
        raise ParameterError.expected(
            "a kind of its own", f"{kind!r}, which is {taken.__name__}", "choose another name"
        )
    _MODELS[kind] = model
    return model


def forget(kind: str) -> None:
    """Make a kind unknown again, as tests need it."""
    _MODELS.pop(kind, None)


def actuator_from_dict(data: dict[str, Any]) -> Nonlinearity:
    """Actuator of any kind from its ``to_dict()``.

    Raises
    ------
    ParameterError
        An unknown kind, or missing numbers.

    Examples
    --------
    >>> actuator_from_dict({"kind": "backlash", "width": 2.0})
    Backlash(width=2.0)
    """
    if data.get("kind") not in _MODELS:
        raise ParameterError.expected(f"kind out of {sorted(_MODELS)}", repr(data.get("kind")), "use to_dict()")
    made: Nonlinearity = _MODELS[data["kind"]].from_dict(data)
    return made
