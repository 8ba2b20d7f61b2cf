"""Treemap of a plant: areas, in them loops by priority; the rest of each label together in a tile."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from lostmotion.plant import PlantLoop
from lostmotion.report.plant.svg.element import element, percent
from lostmotion.report.plant.words import FINDING, LETTER, headline, mark
from lostmotion.store.rows import AssessmentRow

LEAST = 6.0  # of the priority: a tile that can still be hit
OTHERS = 1.5  # of the priority, for each of the loops that are drawn as one tile
MOST_LOOPS = 120  # with a tile of their own; smaller tiles cannot be read
MOST_AREAS = 24
HEAD = 22  # pixels for the name of an area
LETTERS = 7.6  # pixels of a letter in bold
Box = tuple[float, float, float, float]  # x, y, width, height


@dataclass(frozen=True)
class Tile:
    """A rectangle with its text.

    Attributes
    ----------
    weight : float
        What its area is in proportion to.
    name, words : str
        Text inside, and the whole of it for who points or listens.
    label : str
        NE 107; empty: none.
    link : str
        Address; empty: none.
    mark : str
        Letter or sign below the name.
    """

    weight: float
    name: str
    words: str
    label: str = ""
    link: str = ""
    mark: str = ""


def treemap(
    rows: Sequence[AssessmentRow],
    loops: dict[str, PlantLoop],
    address: Callable[[str], str],
    wide: int = 1200,
    high: int = 420,
) -> Markup:
    """Tiles of all loops, by area.

    Parameters
    ----------
    rows : sequence of AssessmentRow
        One a loop, highest priority first.
    loops : dict of PlantLoop
        By tag.
    address : callable
        Address of a loop; "" where there is none.
    wide, high : int
        Pixels for which the layout is made; it is stretched to the width there is.
    """
    return drawn(tiles_by_area(rows, loops, address), len(rows), wide, high)


def drawn(areas: Sequence[tuple[str, Sequence[Tile]]], loops: int, wide: int = 1200, high: int = 420) -> Markup:
    """Areas with their tiles, largest first; `loops` is how many there are in all of them."""
    if not areas:
        return Markup("")
    weights = [sum(tile.weight for tile in tiles) for _, tiles in areas]
    boxes = squarified(weights, (0.0, 0.0, float(wide), float(high)))
    parts = [_area(name, tiles, box, wide, high) for (name, tiles), box in zip(areas, boxes, strict=True)]
    said = f"{loops} loops in {len(areas)} areas; the size of a tile is its priority. The ranking has the numbers."
    return element(
        "svg", element("title", "Treemap by area and priority"), element("desc", said), *parts,
        class_="treemap", role="group", aria_label=f"Treemap by area and priority. {said}", width="100%", height=high,
    )  # fmt: skip


def tiles_by_area(
    rows: Sequence[AssessmentRow], loops: dict[str, PlantLoop], address: Callable[[str], str]
) -> list[tuple[str, list[Tile]]]:
    """Tiles of every area, largest first; areas beyond MOST_AREAS together."""
    own = [row for row in rows if row.priority][:MOST_LOOPS]
    tags = {row.tag for row in own}
    weights: dict[str, float] = defaultdict(float)
    rest: dict[tuple[str, str], int] = defaultdict(int)
    for row in rows:
        area = loops[row.tag].area
        weights[area] += (row.priority or 0.0) + 0.01
        rest[area, row.label] += row.tag not in tags
    return arranged(own, loops, rest, weights, address)


def arranged(
    own: Sequence[AssessmentRow],
    loops: Mapping[str, PlantLoop],
    rest: Mapping[tuple[str, str], int],
    weights: Mapping[str, float],
    address: Callable[[str], str],
    others: Callable[[str, str], str] | None = None,
) -> list[tuple[str, list[Tile]]]:
    """Tiles of every area, largest first.

    Parameters
    ----------
    own : sequence of AssessmentRow
        Loops with a tile of their own.
    loops : mapping of str to PlantLoop
        Of these, by tag.
    rest : mapping of (str, str) to int
        How many others there are, by area and label.
    weights : mapping of str to float
        By area: those with the least are drawn together.
    address : callable
        Address of a loop; "" where there is none.
    others : callable, optional
        Address of the rest of an area with a label.
    """
    known = set(sorted(weights, key=lambda area: -weights[area])[:MOST_AREAS])
    tiles: dict[str, list[Tile]] = defaultdict(list)
    for row in own:
        words = f"{row.tag}: {headline(row)}; priority {row.priority:.0f}"
        tile = Tile(max(row.priority or 0.0, LEAST), row.tag, words, row.label, address(row.tag), mark(row))
        tiles[_named(loops[row.tag].area, known)].append(tile)
    counts: dict[tuple[str, str], int] = defaultdict(int)
    links: dict[tuple[str, str], str] = {}
    for (area, label), count in rest.items():
        counts[_named(area, known), label] += count
        links[_named(area, known), label] = others(area, label) if others and area in known else ""
    for (name, label), count in counts.items():
        if count:
            said = f"{name}: {count} loops {label or 'without a label: not cleared'}, priority low or none"
            weight = max(OTHERS * count**0.5, 0.5 * LEAST)
            tiles[name].append(Tile(weight, str(count), said, label, links[name, label], LETTER.get(label, "")))
    found = [(area, sorted(inside, key=lambda tile: -tile.weight)) for area, inside in tiles.items()]
    return sorted(found, key=lambda pair: -sum(tile.weight for tile in pair[1]))


def _named(area: str, known: Container[str]) -> str:
    return area or "no area given" if area in known else "other areas"


def squarified(weights: Sequence[float], box: Box) -> list[Box]:
    """Boxes in proportion to weights (largest first), as near to squares as they come.

    Bruls, Huizing and van Wijk, "Squarified treemaps", 2000.

    Examples
    --------
    >>> squarified([2.0, 1.0, 1.0], (0.0, 0.0, 4.0, 2.0))
    [(0.0, 0.0, 2.0, 2.0), (2.0, 0.0, 2.0, 1.0), (2.0, 1.0, 2.0, 1.0)]
    """
    total = sum(weights)
    x, y, width, height = box
    areas = [weight / total * width * height for weight in weights]
    found: list[Box] = []
    while areas:
        side = min(width, height)
        count = 1
        while count < len(areas) and _worst(areas[: count + 1], side) <= _worst(areas[:count], side):
            count += 1
        row, areas = areas[:count], areas[count:]
        thick = sum(row) / side
        at = 0.0
        for area in row:
            long = area / thick
            found.append((x, y + at, thick, long) if width >= height else (x + at, y, long, thick))
            at += long
        if width >= height:
            x, width = x + thick, max(width - thick, 1e-9)
        else:
            y, height = y + thick, max(height - thick, 1e-9)
    return found


def _worst(row: Sequence[float], side: float) -> float:
    """Longest over shortest side of the boxes of a row, the worst of them."""
    thick = sum(row) / side
    return max(max(thick * thick / area, area / (thick * thick)) for area in row)


def _area(name: str, tiles: Sequence[Tile], box: Box, wide: int, high: int) -> Markup:
    x, y, width, height = box
    boxes = squarified([tile.weight for tile in tiles], (x, y + HEAD, width, max(height - HEAD, 1.0)))
    inside = [_tile(tile, place, wide, high) for tile, place in zip(tiles, boxes, strict=True)]
    text = element("text", _cut(name, width), class_="area", x="6", y="15")
    return _placed(box, wide, high, "areabox", element("title", name), text) + Markup("").join(inside)


def _tile(tile: Tile, box: Box, wide: int, high: int) -> Markup:
    texts = [
        element("text", _cut(tile.name, box[2]), class_="name", x="6", y="16", aria_hidden="true"),
        element("text", tile.mark, class_="letter", x="6", y="32", aria_hidden="true"),
    ]
    kind = (tile.label or ("finding" if tile.mark == FINDING else "cannot tell")).replace(" ", "-")
    placed = _placed(box, wide, high, f"tile {kind}", element("title", tile.words), *texts)
    return element("a", placed, href=tile.link) if tile.link else placed


def _cut(name: str, width: float) -> str:
    """As much of a name as there is room for."""
    room = max(int((width - 10.0) / LETTERS), 1)
    return name if len(name) <= room else f"{name[: room - 1]}…"


def _placed(box: Box, wide: int, high: int, kind: str, *children: Markup) -> Markup:
    """Its own drawing, so that text is cut at its edge."""
    x, y, width, height = box
    back = element("rect", x="1", y="1", width="100%", height="100%", rx="2")
    return element(
        "svg", children[0], back, *children[1:],
        class_=kind, x=percent(x / wide), y=percent(y / high), width=percent(width / wide),
        height=percent(height / high),
    )  # fmt: skip
