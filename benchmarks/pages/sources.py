"""From which source a script works: the modules that Python would import for it, found without importing any.

Imports inside functions count. A name of a package that loads lazily (`lm.identify`) leads to its module through the
package's ``__init__.pyi``. What is imported or run by a name in a string is not seen: it stands in the catalogue.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = Path("benchmarks", "pages")  # makes pages, changes no figure in them
SHOWN = 12  # hexadecimal digits of a digest


def digest(script: Path, also: Iterable[str] = (), root: Path = ROOT, without: Iterable[str] = ()) -> str:
    """Fingerprint of all that a script depends on; the same where only docstrings, comments or layout differ."""
    whole = hashlib.sha256()
    for path in sources(script, also, root, without):
        whole.update(f"{path.relative_to(root).as_posix()} {_fingerprint(path)}\n".encode())
    return whole.hexdigest()[:SHOWN]


def sources(script: Path, also: Iterable[str] = (), root: Path = ROOT, without: Iterable[str] = ()) -> list[Path]:
    """Files that a script depends on, itself included, in order of their names.

    Parameters
    ----------
    script : Path
    also : iterable of str
        Patterns of further files, relative to `root`: what the script reads, or runs by its name.
    without : iterable of str
        Files that are imported only by functions that the script does not call so, and all that they alone import.
    """
    left_out = {root / name for name in without}
    found = set(left_out)
    for start in [script.resolve(), *_matches(also, root)]:
        _follow(start, start.parent, root, found)
    return sorted(path for path in found - left_out if not path.is_relative_to(root / LEFT_OUT))


def forget() -> None:
    """Read all files anew: while pages are made, hours pass."""
    for cached in (_files, _tree, _imported, _stub, _fingerprint):
        cached.cache_clear()


def _matches(patterns: Iterable[str], root: Path) -> Iterator[Path]:
    for pattern in patterns:
        paths = sorted(root.glob(pattern))
        if not paths:
            raise FileNotFoundError(f"expected files {pattern}, got none; mend the catalogue of the pages")
        yield from paths


def _follow(path: Path, beside: Path, root: Path, found: set[Path]) -> None:
    """Add a file and all that it imports; `beside` is the folder that Python searches first."""
    waiting = [path]
    while waiting:
        path = waiting.pop()
        if path in found:
            continue
        found.add(path)
        if path.suffix == ".py":
            for name in _imported(path, root):
                waiting += _files(name, (beside, root, root / "src"))


@cache
def _files(name: str, places: tuple[Path, ...]) -> list[Path]:
    """File of a module and those of the packages around it; none for what is not of this repository."""
    parts = name.split(".")
    for place in places:
        last = _file(place.joinpath(*parts))
        if last is not None:
            around = (_file(place.joinpath(*parts[:k])) for k in range(1, len(parts)))
            return [last, *(package for package in around if package is not None)]
    return []


def _file(module: Path) -> Path | None:
    choices = (module / "__init__.py", module.with_name(module.name + ".py"))
    return next((path for path in choices if path.is_file()), None)


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def _imported(path: Path, root: Path) -> tuple[str, ...]:
    """Dotted names of everything that a module may import; some are names in modules and lead nowhere."""
    return tuple(dict.fromkeys(_names(path, root)))


def _names(path: Path, root: Path) -> Iterator[str]:
    tree = _tree(path)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
                if _stub(_stub_path(alias.name, root)):
                    yield from _lazily(alias.name, _used(tree, alias), root)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join([*_package(path, node.level, root), *(node.module or "").split(".")]).strip(".")
            names = [alias.name for alias in node.names]
            yield from (base, *(f"{base}.{name}" for name in names))
            yield from _lazily(base, names, root)


def _package(path: Path, level: int, root: Path) -> tuple[str, ...]:
    """Package that `level` dots mean in a module."""
    if level == 0:
        return ()
    place = root / "src" if path.is_relative_to(root / "src") else root
    return path.relative_to(place).parts[:-level]


def _used(tree: ast.Module, alias: ast.alias) -> list[str] | None:
    """Attributes of an imported module that are used; None where it is used otherwise, so that all may be."""
    bound = alias.asname or alias.name
    nodes = list(ast.walk(tree))
    uses = [node for node in nodes if isinstance(node, ast.Name) and node.id == bound]
    owners = {id(node.value): node.attr for node in nodes if isinstance(node, ast.Attribute)}
    names = [owners[id(use)] for use in uses if id(use) in owners]
    return names if len(names) == len(uses) else None


def _lazily(package: str, names: list[str] | None, root: Path) -> Iterator[str]:
    """Modules behind the names of a package whose ``__init__.pyi`` says what is loaded lazily; so may those be."""
    offered = _stub(_stub_path(package, root))
    for name in offered if names is None else names:
        modules = [f"{package}.{module}" for module in offered.get(name, ())]
        yield from modules
        if modules and _stub(_stub_path(modules[0], root)):
            yield from _lazily(modules[0], [name], root)


def _stub_path(package: str, root: Path) -> Path:
    return root.joinpath("src", *package.split("."), "__init__.pyi")


@cache
def _stub(path: Path) -> dict[str, tuple[str, ...]]:
    """Where each name of a stub comes from, relative to its package."""
    if not path.is_file():
        return {}
    lines = [node for node in _tree(path).body if isinstance(node, ast.ImportFrom)]
    return {
        alias.name: (node.module, f"{node.module}.{alias.name}") if node.module else (alias.name,)
        for node in lines
        for alias in node.names
    }


@cache
def _fingerprint(path: Path) -> str:
    if path.suffix == ".py":
        return hashlib.sha256(repr(_skeleton(_tree(path))).encode()).hexdigest()
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _skeleton(node: object) -> object:
    """Syntax tree as tuples, without docstrings, places and empty fields, which differ between versions of Python."""
    if isinstance(node, list):
        return tuple(_skeleton(item) for item in node)
    if not isinstance(node, ast.AST):
        return node
    fields = dict(ast.iter_fields(node))
    if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and _documented(node):
        fields["body"] = node.body[1:]
    kept = ((name, value) for name, value in fields.items() if value not in (None, []) and name != "kind")
    return (type(node).__name__, *((name, _skeleton(value)) for name, value in kept))


def _documented(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    return ast.get_docstring(node, clean=False) is not None
