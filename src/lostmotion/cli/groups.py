"""Options that belong together: a dataclass in the signature of a command stands for its fields.

::

    def check(files: Files, columns: RecordOptions, output: OutputOptions) -> None: ...

has on the command line every field of ``RecordOptions`` and ``OutputOptions`` as an option of its own.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import wraps
from typing import Any, get_type_hints


def spread(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of its groups.

    Parameters
    ----------
    command : callable
        Its parameters are options, arguments, or dataclasses of options. An option that two groups name alike is one
        option, as the first declares it, and both get its value.

    Returns
    -------
    callable
        With keyword parameters only, as Typer reads them.
    """
    hints = get_type_hints(command, include_extras=True)
    groups = {name: kind for name, kind in hints.items() if is_dataclass(kind)}
    parameters: dict[str, inspect.Parameter] = {}
    for own in inspect.signature(command).parameters.values():
        for one in _options(groups[own.name]) if own.name in groups else [_option(own, hints[own.name])]:
            parameters.setdefault(one.name, one)

    @wraps(command)
    def whole(**given: Any) -> None:
        own = {name: given[name] for name in inspect.signature(command).parameters if name not in groups}
        command(**own, **{name: _filled(kind, given) for name, kind in groups.items()})

    whole.__signature__ = inspect.Signature(list(parameters.values()))  # type: ignore[attr-defined]
    whole.__annotations__ = {name: one.annotation for name, one in parameters.items()}
    return whole


def _options(group: Any) -> list[inspect.Parameter]:
    hints = get_type_hints(group, include_extras=True)
    return [_option(one, hints[one.name]) for one in inspect.signature(group).parameters.values()]


def _option(parameter: inspect.Parameter, hint: Any) -> inspect.Parameter:
    return parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=hint)


def _filled(group: Any, given: dict[str, Any]) -> Any:
    return group(**{one.name: given[one.name] for one in fields(group)})
