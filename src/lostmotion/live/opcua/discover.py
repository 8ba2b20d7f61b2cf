"""Loops of a server by the names of its nodes: a proposal that a person corrects."""

from __future__ import annotations

from collections.abc import AsyncIterator

from asyncua import ua
from asyncua.client.client import Client
from asyncua.common.node import Node
from asyncua.ua.object_ids import ObjectIds

from lostmotion.files.tags import loops_of
from lostmotion.plant.loop import PlantLoop

DEEPEST = 8  # folders inside each other
MOST = 100_000  # variables that are looked at


async def discovered(client: Client) -> tuple[PlantLoop, ...]:
    """Loops whose OP and PV are both there, with SP and mode where they are.

    The tag is the path below Objects: ``Unit1/FIC101``. Where the node ids are texts with a tag and a role in them,
    these are tried first: they are what the engineer wrote.
    """
    names: dict[str, str] = {}
    idents: dict[str, str] = {}
    async for path, node in _variables(client.nodes.objects, ()):
        names[_name(path)] = node.nodeid.to_string()
        if isinstance(node.nodeid.Identifier, str):
            idents[str(node.nodeid.Identifier)] = node.nodeid.to_string()
        if len(names) >= MOST:
            break
    found = loops_of(idents)
    known = idents
    if not found:
        found, known = loops_of(names), names
    return tuple(_loop(tag, {role: known[name] for role, name in roles.items()}) for tag, roles in found.items())


def _loop(tag: str, nodes: dict[str, str]) -> PlantLoop:
    return PlantLoop(tag, nodes["op"], nodes["pv"], nodes.get("sp", ""), nodes.get("mode", ""))


def _name(path: tuple[str, ...]) -> str:
    return "/".join(path[:-1]) + "." + path[-1] if len(path) > 1 else path[0]


async def _variables(parent: Node, path: tuple[str, ...]) -> AsyncIterator[tuple[tuple[str, ...], Node]]:
    """Variables below a node that are no part of the server itself, with their paths."""
    if len(path) >= DEEPEST:
        return
    for found in await parent.get_children_descriptions(refs=ObjectIds.HierarchicalReferences):
        if found.NodeId.NamespaceIndex == 0:
            continue
        node = Node(parent.session, found.NodeId)
        here = (*path, str(found.BrowseName.Name))
        if found.NodeClass == ua.NodeClass.Variable:
            yield here, node
        async for one in _variables(node, here):
            yield one
