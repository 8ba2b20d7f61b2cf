"""The one place where files are written: whole or not at all, never through a link, nothing left over.

Bytes go to a file without a name, which Linux removes by itself when a process dies; it gets its name when all are on
the disk. Names are given by one process at a time in a folder. Where a file is replaced, it has a second name between
two system calls; a kill just there leaves it, and the next write of that file takes it away. Elsewhere (Windows, some
network drives) that second name is there from the beginning, another each time, and :func:`sweep` finds it.
"""

from __future__ import annotations

import errno
import hashlib
import os
import secrets
import stat
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from lostmotion.errors import FileAccessError
from lostmotion.files.alone import alone, locked, retried
from lostmotion.files.folders import MOST_NEW, depth, made, make, nearest
from lostmotion.files.write_errors import write_errors

PLAIN = 0o666  # mode of a new file, less what the umask of the process takes away
PRIVATE = 0o600  # of a key: nobody else reads it, from its first byte on
_BINARY = getattr(os, "O_BINARY", 0)  # Windows
_SELF = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # no link, and no waiting for a pipe
_ROOM = "~" * 45  # as long as a second name
_NAMELESS = getattr(os, "O_TMPFILE", 0) if Path("/proc/self/fd").is_dir() else 0
Buffer = bytes | memoryview
_PATHLIKE = str | os.PathLike[str]


def refuse(path: _PATHLIKE, force: bool = False) -> Path:
    """Path of a file that can be written, as far as can be known before.

    Raises
    ------
    FileAccessError
        It exists and `force` is not set; it is a link, a folder or a device; its folder cannot be made or written;
        no file can have that name.
    """
    target = Path(path)
    with write_errors(target):
        _refuse_folder(target.parent)
        with suppress(FileNotFoundError):
            _refuse_present(target, target.lstat().st_mode, force)
    return target


def refuse_folder(folder: _PATHLIKE, names: Iterable[str]) -> None:
    """Raise FileAccessError where files of these names could not be written, or the folder not be made."""
    place = Path(folder)
    with write_errors(place):
        if os.path.lexists(place):
            if not place.is_dir():
                raise FileAccessError(f"expected a folder, got the file {str(place)!r}; choose another")
            for name in names:
                refuse(place / name, force=True)
            return
        above = nearest(place)
        _refuse_folder(above)
        parts = [above / part for part in place.absolute().relative_to(above).parts]
        for path in [*parts, *(place.absolute() / name for name in (*names, _ROOM))]:
            with suppress(FileNotFoundError):
                path.lstat()  # a name or a path that is too long is told now


def write_bytes(path: _PATHLIKE, data: Buffer, force: bool = False) -> Path:
    """Write a file in one step: after a crash or a power cut it is the old one or the new one. Its folder is made.

    Raises
    ------
    FileAccessError
        See :func:`refuse`; and a full disk, which leaves what was there.
    """
    return write_together({Path(path): data}, force)[0]


def write_together(files: Mapping[Path, Buffer], force: bool = False, mode: int = PLAIN) -> list[Path]:
    """Write all files or none: all are on the disk before the first gets its name, and an error takes new names back.

    Only a kill between the naming of two of them, which takes microseconds, can leave the first without the others.

    Raises
    ------
    FileAccessError
        As in :func:`write_bytes`, for any of them; then none is new.
    """
    targets = [refuse(path, force) for path in files]
    drafts: list[_Draft] = []
    with ExitStack() as stack:
        for target in targets:
            stack.enter_context(write_errors(target))
            stack.enter_context(made(target.parent))
        try:
            for target, data in zip(targets, files.values(), strict=True):
                drafts.append(_Draft(target, target.parent, mode))
                drafts[-1].fill(data)
            _place(drafts, force)
        finally:
            for draft in drafts:
                draft.close()
    return targets


def write_folder(folder: _PATHLIKE, files: Mapping[str, Buffer], force: bool = False, mode: int = PLAIN) -> list[Path]:
    """Write files into a folder; one that is not there appears with all of them at once, new ones with this mode.

    Raises
    ------
    FileAccessError
        As in :func:`write_together`; or the folder cannot be made.
    """
    place = Path(folder)
    refuse_folder(place, files)
    if place.is_dir():
        return write_together({place / name: data for name, data in files.items()}, force, mode)
    with write_errors(place):
        place.parent.mkdir(parents=True, exist_ok=True)
        drafts: list[_Draft] = []
        try:
            for name, data in files.items():
                drafts.append(_Draft(place / name, place.parent, mode))
                drafts[-1].fill(data)
            with _naming(place.parent) as only:
                _place_folder(place, drafts, only)
        finally:
            for draft in drafts:
                draft.close()
        _settle(place.parent)
    return [place / name for name in files]


def sweep(path: _PATHLIKE) -> None:
    """Remove what a killed process has left of `path`; only for who alone works with it, see :func:`lock_file`."""
    target = Path(path)
    for left in target.parent.glob(f"{_prefix(target)}*"):
        with suppress(OSError):
            left.unlink()


def lock_file(path: Path) -> BinaryIO:
    """Keep other processes of lostmotion from working with `path` until what is returned is closed, or we end.

    The file that holds the lock stays; it is empty.

    Raises
    ------
    FileAccessError
        Another process works with it, or the folder cannot be written.
    """
    beside = refuse(path.with_name(f".{path.name}.lock"), force=True)
    with write_errors(beside):
        make(beside.parent)
        number = os.open(beside, os.O_RDWR | os.O_CREAT | _SELF, PLAIN)
    stream = os.fdopen(number, "rb")
    if not locked(number):
        stream.close()
        raise FileAccessError(f"expected {path} for this process alone, got another one that works with it")
    return stream


class _Draft:
    """Bytes on the disk of a folder that are not yet under their name."""

    def __init__(self, target: Path, folder: Path, mode: int = PLAIN) -> None:
        self.target, self._mode, self._placed = target, mode, False
        self.beside: Path | None = None  # second name
        with write_errors(target):
            self._stream = self._open(folder)

    def _open(self, folder: Path) -> BinaryIO:
        if _NAMELESS:
            with suppress(OSError):
                return os.fdopen(os.open(folder, _NAMELESS | os.O_WRONLY, self._mode), "wb")
        self.beside = folder / _second_name(self.target)
        return os.fdopen(os.open(self.beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY, self._mode), "wb")

    def fill(self, data: Buffer) -> None:
        """Put the bytes on the disk, under the permissions of the file that they replace."""
        with write_errors(self.target, len(data)):
            if hasattr(os, "fchmod") and self.target.is_file():
                os.fchmod(self._stream.fileno(), stat.S_IMODE(self.target.stat().st_mode))
            self._stream.write(data)
            self._stream.flush()
            os.fsync(self._stream.fileno())

    def name_it(self, force: bool, only: bool = False) -> None:
        """Give the bytes their name; without `force` no file of that name is replaced, even one made just now.

        `only`: nobody else names anything in the folder meanwhile.
        """
        with write_errors(self.target):
            if self.beside is None:
                beside = self.target.parent / _second_name(self.target, only)
                if only:
                    beside.unlink(missing_ok=True)  # of a process that was killed
                if not os.path.lexists(self.target):
                    self._link(self.target)
                    self._placed = True
                    return
                self._link(beside)
                self.beside = beside
            self._stream.close()
            (_replace if force else _rename)(self.beside, self.target)
            self._placed, self.beside = True, None

    def _link(self, path: Path) -> None:
        """Name of a file without one; the number of a folder makes Python follow /proc to the file."""
        here = os.open(path.parent, os.O_RDONLY)
        try:
            os.link(f"/proc/self/fd/{self._stream.fileno()}", path, src_dir_fd=here)
        finally:
            os.close(here)

    def take_back(self) -> None:
        """Remove what was named."""
        if self._placed:
            self.target.unlink(missing_ok=True)

    def close(self) -> None:
        """Let go; what has no name is gone."""
        with suppress(OSError):
            self._stream.close()
        if self.beside is not None:
            self.beside.unlink(missing_ok=True)


def _replace(beside: Path, target: Path) -> None:
    """Rename a file to a name that may be taken; Windows waits for who has that one open."""
    if sys.platform != "win32":
        beside.replace(target)
        return
    try:
        retried(lambda: beside.replace(target))
    except PermissionError as error:
        raise FileAccessError(
            f"expected {str(target)!r} closed, got it open in another program, or read-only; close it and try again"
        ) from error


def _rename(beside: Path, target: Path) -> None:
    """Rename a file to a name that is free; one that was taken just now is kept."""
    if sys.platform == "win32":  # there a rename replaces nothing
        beside.rename(target)
        return
    try:
        os.link(beside, target)
    except FileExistsError:
        raise
    except OSError:  # a drive on which a file has one name
        if os.path.lexists(target):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        beside.rename(target)
    else:
        beside.unlink()


def _place(drafts: list[_Draft], force: bool) -> None:
    """Name all drafts; where one fails, those that are new are taken away again."""
    folders = sorted({draft.target.parent for draft in drafts})
    with ExitStack() as stack:
        waited = [stack.enter_context(_naming(folder)) for folder in folders]
        new = [draft for draft in drafts if not os.path.lexists(draft.target)]
        try:
            for draft in drafts:
                draft.name_it(force, all(waited))
        except BaseException:
            for draft in new:
                draft.take_back()
            raise
    for folder in folders:
        _settle(folder)


def _place_folder(place: Path, drafts: list[_Draft], only: bool) -> None:
    """Name all drafts in a second folder, which then gets the name of the first."""
    beside = place.parent / _second_name(place, only)
    if only and beside.is_dir():  # of a process that was killed
        _remove(beside)
    beside.mkdir()
    try:
        for draft in drafts:
            draft.target = beside / draft.target.name
            draft.name_it(force=False)
        beside.rename(place)
    except BaseException:
        _remove(beside)
        raise


def _remove(folder: Path) -> None:
    for path in folder.iterdir():
        path.unlink()
    folder.rmdir()


@contextmanager
def _naming(folder: Path) -> Iterator[bool]:
    """Whether nobody else gives names in the folder meanwhile; false where second names are there for longer."""
    with alone(folder) as only:
        yield only and bool(_NAMELESS)


def _settle(folder: Path) -> None:
    """Names on the disk as well, where the platform can; what was written stands in any case."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def _prefix(target: Path) -> str:
    return f".lostmotion-{hashlib.sha256(os.fsencode(target.name)).hexdigest()[:16]}-"


def _second_name(target: Path, only: bool = False) -> str:
    """Of one length, so that a name that is just short enough stays so; the same each time for the only one."""
    return f"{_prefix(target)}{'0' * 16 if only else secrets.token_hex(8)}"


def _refuse_present(target: Path, mode: int, force: bool) -> None:
    said = repr(str(target))
    if stat.S_ISDIR(mode):
        raise FileAccessError(f"expected a file name, got the folder {said}; add a file name")
    if stat.S_ISLNK(mode):
        raise FileAccessError(f"expected a file, got the link {said}; give the file itself")
    if not stat.S_ISREG(mode):
        raise FileAccessError(f"expected a file, got {said}, which is a device or a pipe; give a new name")
    if not force:
        raise FileAccessError(f"expected a new file, got {said}, which exists; use force=True to replace it")


def _refuse_folder(folder: Path) -> None:
    above = nearest(folder)
    if depth(folder) > MOST_NEW:
        raise FileAccessError(f"expected a folder that can be written, got {str(folder)[:200]!r}; choose another path")
    if not above.is_dir():
        raise FileAccessError(f"expected a folder {str(folder)!r}, got the file {str(above)!r}; choose another path")
    if not os.access(above, os.W_OK | os.X_OK):
        raise FileAccessError(f"expected a folder that can be written, got {str(folder)!r}; choose another")
