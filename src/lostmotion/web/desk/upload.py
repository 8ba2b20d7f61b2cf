"""Files of a form, streamed to the disk as they come: nothing is held in memory, nothing is larger than it may be."""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING

from python_multipart.exceptions import MultipartParseError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from lostmotion.errors import InputError
from lostmotion.web.desk.desk import Desk, Draft, too_large
from lostmotion.web.desk.item import Item

if TYPE_CHECKING:
    from python_multipart.multipart import MultipartCallbacks

AT_ONCE = 4  # uploads
MOST_PARTS = 40  # of a form
HEAD_BYTES = 8192  # of a part before its content
AROUND = 1 << 20  # bytes of a form beside its files
FIELD = "file"
_running = 0
logging.getLogger("python_multipart").addHandler(logging.NullHandler())  # what is wrong with a form is answered


async def received(request: Request, desk: Desk) -> list[Item]:
    """Items of the files of a form; their jobs are begun.

    Raises
    ------
    HTTPException
        413: larger than a file may be. 400: no such form. 503: too many at once.
    """
    global _running  # noqa: PLW0603  one page a process
    _refuse_length(request, desk.limits.file_bytes + AROUND)
    if _running >= AT_ONCE:
        raise HTTPException(503, "Too many files are being dropped at once; try again in a moment.")
    _running += 1
    form = Form(desk, _boundary(request))
    try:
        async for piece in request.stream():
            await run_in_threadpool(form.take, piece)
        return await run_in_threadpool(form.items)
    except (InputError, MultipartParseError) as error:
        raise HTTPException(413 if isinstance(error, InputError) else 400, str(error)) from error
    except ClientDisconnect as error:
        raise HTTPException(400, "The rest of the file did not come.") from error
    finally:
        _running -= 1
        await asyncio.shield(run_in_threadpool(form.close))


def _refuse_length(request: Request, most: int) -> None:
    length = request.headers.get("content-length", "")
    if length.isdigit() and int(length) > most:
        raise HTTPException(413, str(too_large(most - AROUND)))


def _boundary(request: Request) -> bytes:
    kind, options = parse_options_header(request.headers.get("content-type", ""))
    boundary = options.get(b"boundary", b"")
    if kind != b"multipart/form-data" or not 0 < len(boundary) <= 200:
        raise HTTPException(400, "expected a form with a file, got something else; use the page's own form")
    return boundary


class Form:
    """Parts of a form, each file into a draft of the desk."""

    def __init__(self, desk: Desk, boundary: bytes) -> None:
        self._desk = desk
        self._drafts: list[tuple[str, Draft, str]] = []
        self._now: Draft | None = None
        self._name, self._value, self._about = bytearray(), bytearray(), b""
        self._parts = self._heads = self._size = 0
        calls: MultipartCallbacks = {
            "on_part_begin": self._begin,
            "on_part_data": self._data,
            "on_part_end": self._end,
            "on_header_field": lambda data, start, end: self._head(self._name, data[start:end]),
            "on_header_value": lambda data, start, end: self._head(self._value, data[start:end]),
            "on_header_end": self._header,
            "on_headers_finished": self._file,
        }
        self._parser = MultipartParser(boundary, calls)

    def take(self, piece: bytes) -> None:
        """Next bytes of the form."""
        self._size += len(piece)
        if self._size > self._desk.limits.file_bytes + AROUND:
            raise too_large(self._desk.limits.file_bytes)
        self._parser.write(piece)

    def items(self) -> list[Item]:
        """Items of all files; nothing is left to be closed."""
        self._parser.finalize()
        if not self._drafts or self._now is not None:
            raise HTTPException(400, "expected a form with a file, got none; choose one")
        drafts, self._drafts = self._drafts, []
        return [self._desk.dropped(number, draft, label) for number, draft, label in drafts]

    def close(self) -> None:
        """Remove what was not made an item."""
        for _, draft, _ in self._drafts:
            draft.drop()
        self._drafts = []

    def _begin(self) -> None:
        self._parts, self._heads, self._about = self._parts + 1, 0, b""
        if self._parts > MOST_PARTS:
            raise MultipartParseError("too many parts")

    def _head(self, into: bytearray, data: bytes) -> None:
        self._heads += len(data)
        if self._heads > HEAD_BYTES:
            raise MultipartParseError("a part with a long head")
        into += data

    def _header(self) -> None:
        if bytes(self._name).lower() == b"content-disposition":
            self._about = bytes(self._value)
        self._name.clear()
        self._value.clear()

    def _file(self) -> None:
        _, options = parse_options_header(self._about)
        label = options.get(b"filename", b"")
        if options.get(b"name") == FIELD.encode() and label:
            number, self._now = self._desk.draft()
            self._drafts.append((number, self._now, label.decode("utf-8", "replace")))

    def _data(self, data: bytes, start: int, end: int) -> None:
        if self._now is not None:
            self._now.write(data[start:end])

    def _end(self) -> None:
        if self._now is not None:
            self._now.close()
        self._now = None
