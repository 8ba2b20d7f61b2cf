"""The columns of each loop of a wide table, with those that loops share, so that reading all loops is linear."""

from __future__ import annotations

from collections.abc import Sequence

from lostmotion.files.quality import names_of_quality, without_name
from lostmotion.files.tags import key, loops_of, tag_and_role


def columns_to_read(names: Sequence[str]) -> dict[str, list[str]]:
    """Columns that :func:`lostmotion.read_loop` looks at for each loop, by its tag, in the order of the table.

    Parameters
    ----------
    names : sequence of str
        All columns.

    Returns
    -------
    dict of str to list of str
        Empty where columns of quality belong to others by their places alone, which a part of a table does not show.

    Examples
    --------
    >>> columns_to_read(["Time", "FC1.PV", "FC1.OUT", "FC1.PV.Status", "FC2.PV", "FC2.OUT"])["FC1"]
    ['Time', 'FC1.PV', 'FC1.OUT', 'FC1.PV.Status']
    """
    if len(without_name(names)) > 1:
        return {}
    place = {name: number for number, name in enumerate(names)}
    called: dict[str, list[str]] = {}
    for name in names:
        called.setdefault(key(name), []).append(name)
    own: dict[str, set[str]] = {}
    for tag, roles in loops_of(names).items():
        beside = (called.get(word, ()) for column in roles.values() for word in names_of_quality(column))
        own[tag] = {*roles.values(), *(name for found in beside for name in found)}
    taken = set().union(*own.values())
    shared = {name for name in names if name not in taken and tag_and_role(name) is None}
    return {tag: sorted(columns | shared, key=place.__getitem__) for tag, columns in own.items()}
