"""Running monitors: what `online` and `live` report, as it comes."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Sequence
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from lostmotion.web.monitors.monitor import Watched
from lostmotion.web.monitors.said import Said
from lostmotion.web.monitors.svg import width_chart
from lostmotion.web.page import Page, answer, told

EVERY = 1.0  # s between looks at the files while somebody listens
BEAT = 15.0  # s of silence after which a comment is sent: a client that is gone is noticed then at the latest
MOST_CLIENTS = 20  # that listen
WAITING = 32  # news that wait for a client; one that is further behind is sent away and asks anew
MOST_SHOWN = 60  # loops of one page, each with its chart
LONGEST = 300.0  # s of one stream: browsers come again by themselves, and forgotten ones end


class Board:
    """The monitors of a page, and who listens to them."""

    def __init__(self, paths: Sequence[str]) -> None:
        self.watched = [Watched(path) for path in paths]
        self._numbers: dict[tuple[int, str], int] = {}
        self._listening: set[asyncio.Queue[str | None]] = set()
        self._task: asyncio.Task[None] | None = None

    def look(self) -> dict[int, Said]:
        """What is said of each loop, by a number that it keeps: more loops may come."""
        found = {}
        for place, watched in enumerate(self.watched):
            for said in watched.look():
                found[self._numbers.setdefault((place, said.tag), len(self._numbers))] = said
        return found

    @property
    def full(self) -> bool:
        """Nobody more can listen."""
        return len(self._listening) >= MOST_CLIENTS

    async def news(self) -> AsyncIterator[str]:
        """Server-sent events: number and latest state of each monitor that says something new."""
        mine: asyncio.Queue[str | None] = asyncio.Queue(WAITING)
        self._listening.add(mine)
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._watch())
        try:
            yield "retry: 2000\n\n"
            async with asyncio.timeout(LONGEST):
                while True:
                    try:
                        async with asyncio.timeout(BEAT):
                            news = await mine.get()
                    except TimeoutError:
                        yield ": still here\n\n"
                        continue
                    if news is None:
                        return
                    yield news
        except TimeoutError:
            return
        finally:
            self._listening.discard(mine)

    def end(self) -> None:
        """Nobody is told anything any more."""
        for one in tuple(self._listening):
            self._send_away(one)

    def _send_away(self, one: asyncio.Queue[str | None]) -> None:
        self._listening.discard(one)
        if one.full():
            one.get_nowait()
        one.put_nowait(None)

    async def _watch(self) -> None:
        """Look at the files as long as somebody listens."""
        before = {number: one.version for number, one in (await run_in_threadpool(self.look)).items()}
        while self._listening:
            await asyncio.sleep(EVERY)
            said = await run_in_threadpool(self.look)
            for number, one in said.items():
                if one.version != before.get(number):
                    self._tell(number, one)
            before = {number: one.version for number, one in said.items()}

    def _tell(self, number: int, said: Said) -> None:
        data = {"monitor": number, "name": said.title, "status": said.status, "version": said.version}
        text = f"event: changed\ndata: {json.dumps(data)}\n\n"
        for one in tuple(self._listening):
            if one.full():
                self._send_away(one)
            else:
                one.put_nowait(text)


_BOARDS: dict[tuple[str, ...], Board] = {}


def board(paths: tuple[str, ...]) -> Board:
    """Board of these files."""
    return _BOARDS.setdefault(paths, Board(paths))


def end_streams() -> None:
    """End all that is streamed: the page stops."""
    for one in _BOARDS.values():
        one.end()


def routes(page: Page) -> list[Route]:
    """Routes of this part."""

    def monitors(request: Request) -> Response:
        said = board(page.monitors).look()
        part = request.query_params.get("part", "")
        if part.isascii() and part.isdigit() and len(part) < 10 and int(part) in said:
            return answer(page, request, "monitor_part.html.j2", **_shown(int(part), said[int(part)]))
        if part:
            return told(page, request, 404, "Not found", "There is no such monitor.")
        wanted = request.query_params.get("text", "")[:200].casefold()
        chosen = {number: one for number, one in said.items() if wanted in one.title.casefold()}
        first = dict(sorted(chosen.items(), key=lambda pair: _urgency(pair[1]))[:MOST_SHOWN])
        shown = [_shown(number, one) for number, one in chosen.items() if number in first]
        context: dict[str, Any] = {"text": wanted, "total": len(said), "chosen": len(chosen)}
        return answer(page, request, "monitors.html.j2", monitors=shown, **context)

    def as_json(request: Request) -> Response:  # noqa: ARG001  the signature of a route
        said = board(page.monitors).look()
        return JSONResponse({"monitors": [{"monitor": number, **one.to_dict()} for number, one in said.items()]})

    async def events(request: Request) -> Response:
        mine = board(page.monitors)
        if mine.full:
            return told(page, request, 503, "Too many listeners", f"At most {MOST_CLIENTS} can listen at once.")
        return StreamingResponse(mine.news(), media_type="text/event-stream", headers={"x-accel-buffering": "no"})

    return [Route("/monitors", monitors), Route("/monitors/events", events), Route("/api/v1/monitors", as_json)]


def _urgency(said: Said) -> int:
    """What a person has to look at comes first: a monitor that says nothing, a loop with events, the rest."""
    return 0 if said.warnings else 1 if said.events else 2


def _shown(number: int, said: Said) -> dict[str, Any]:
    return {"number": number, "said": said, "chart": width_chart(said.points)}
