"""What was made of the store, kept for as long as the store says the same: most questions are asked again and again."""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Hashable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Generic, TypeVar

from starlette.requests import Request
from starlette.responses import Response

AT_ONCE = 4  # answers that are made: more threads only take the interpreter from each other and from the server
MOST_BYTES = 16_000_000  # of answers: some seventy pages of a plant

Thing = TypeVar("Thing")


class Kept(Generic[Thing]):
    """Things by name, each with the stamp of the store under which it was made.

    Parameters
    ----------
    most : int
        Weight of all that is kept; what was not asked for longest goes first.
    weight : callable, optional
        Of one thing; without it each weighs one.
    """

    def __init__(self, most: int, weight: Callable[[Thing], int] | None = None) -> None:
        self._most, self._held = most, 0
        self._weight = weight or (lambda _: 1)
        self._things: OrderedDict[Hashable, tuple[Hashable, Thing]] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, name: Hashable, stamp: Hashable) -> Thing | None:
        """Thing of this stamp; None: there is none."""
        with self._lock:
            known = self._things.get(name)
            if known is None or known[0] != stamp:
                return None
            self._things.move_to_end(name)
            return known[1]

    def put(self, name: Hashable, stamp: Hashable, thing: Thing) -> None:
        """Keep it in the place of an older one."""
        with self._lock:
            before = self._things.pop(name, None)
            self._held += self._weight(thing) - (self._weight(before[1]) if before else 0)
            self._things[name] = stamp, thing
            while self._held > self._most:
                _, (_, gone) = self._things.popitem(last=False)
                self._held -= self._weight(gone)


class Answers:
    """Answers to GET by their address.

    Parameters
    ----------
    stamp : callable
        What the store says by now, as :meth:`lostmotion.store.asked.Asked.stamp` has it; asked before an answer is
        made, so that one which is overtaken by a change is made again.
    settled : callable
        Whether the run of a request can change no more; of others nothing is kept.
    """

    def __init__(self, stamp: Callable[[], Hashable], settled: Callable[[Request], bool]) -> None:
        self._stamp, self._settled = stamp, settled
        self._kept: Kept[tuple[bytes, str, str]] = Kept(MOST_BYTES, lambda answer: len(answer[0]))
        self._threads = ThreadPoolExecutor(AT_ONCE, "answers")

    def route(self, make: Callable[[Request], Response], *, keep: bool = True) -> Callable[[Request], Awaitable[Any]]:
        """The same question, made by few threads at a time and only where no answer is kept."""
        answer = partial(self._answer, make) if keep else make

        async def answered(request: Request) -> Response:
            return await asyncio.get_running_loop().run_in_executor(self._threads, answer, request)

        return answered

    def _answer(self, make: Callable[[Request], Response], request: Request) -> Response:
        name, stamp = (request.url.path, request.url.query), self._stamp()
        known = self._kept.get(name, stamp)
        if known is None:
            made = make(request)
            if made.status_code != 200 or "content-disposition" in made.headers or not self._settled(request):
                return made
            body = bytes(made.body)
            tag = f'"{hashlib.blake2b(body, digest_size=16).hexdigest()}"'
            known = body, tag, str(made.headers["content-type"])
            self._kept.put(name, stamp, known)
        body, tag, kind = known
        if tag in [one.strip().removeprefix("W/") for one in request.headers.get("if-none-match", "").split(",")]:
            return Response(status_code=304, headers={"etag": tag})
        return Response(body, headers={"etag": tag, "content-type": kind})
