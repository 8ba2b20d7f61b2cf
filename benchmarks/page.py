"""How quick the page is, whether it grows, and how it bears many readers: the real command, asked from outside.

    python -m benchmarks.page [--loops 26000] [--views 1000] [--uploads 50] [--clients 50] [--seconds 20] ..

Times of answers stand beside the processor time that the page itself spent on them: on a busy machine only the latter
can be compared. What a browser shows is measured where Debian's chromium and playwright are there.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import statistics
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from benchmarks.audit.stores import filled

from lostmotion.store.store import Store
from tests.support.served import Served, long_record, put_on_desk

CHROMIUM = Path("/usr/bin/chromium")
TICK = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100
PAGE = os.sysconf("SC_PAGESIZE") if hasattr(os, "sysconf") else 4096
ROUNDS = 9
FIRST = """() => new Promise((done) => new PerformanceObserver((list) => {
  for (const one of list.getEntriesByName('first-contentful-paint')) done(one.startTime);
}).observe({type: 'paint', buffered: true}))"""
QUERIES = {  # {}: a number that is another one each time, so that the answer has to be made
    "plant": "/?page={}",
    "filter by verdict": "/?verdict=stiction&page={}",
    "filter by area and text": "/?area=area+7&text=FIC-0{}",
    "sorted by size": "/?sort=size&page={}",
    "loop": "/loops/FIC-00{}",
    "JSON of a page of loops": "/api/v1/loops?verdict=backlash&page={}",
}


class Asking:
    """One client that keeps its connection."""

    def __init__(self, served: Served) -> None:
        self._host = served.base.removeprefix("http://")
        self._head = {"Authorization": f"Bearer {served.token}"}
        self._line = http.client.HTTPConnection(self._host, timeout=120)

    def get(self, path: str) -> tuple[int, bytes, float]:
        """Status, body, seconds."""
        began = time.perf_counter()
        try:
            self._line.request("GET", path, headers=self._head)
            answer = self._line.getresponse()
            body = answer.read()
        except (http.client.HTTPException, ConnectionError):  # closed after its 5 s of silence
            self._line.close()
            return self.get(path)
        return answer.status, body, time.perf_counter() - began

    def drop(self, name: str, data: bytes) -> tuple[int, bytes]:
        """A file, as a browser drops it."""
        edge = "x8f3a"
        head = f'--{edge}\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n\r\n'
        body = head.encode() + data + f"\r\n--{edge}--\r\n".encode()
        line = http.client.HTTPConnection(self._host, timeout=120)
        kind = {"Content-Type": f"multipart/form-data; boundary={edge}", "Accept": "application/json"}
        line.request("POST", "/files", body, {**self._head, **kind})
        answer = line.getresponse()
        return answer.status, answer.read()


def spent(process: int) -> float:
    """Processor seconds of a process."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def held(process: int) -> float:
    """MB of memory that a process holds."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * PAGE / 1e6


def csv(rows: int = 3000) -> bytes:
    """A small record."""
    lines = [f"{k},{50 + k % 17},{20 + (k // 17) % 5},20" for k in range(rows)]
    return ("time_s,OP,PV,SP\n" + "\n".join(lines) + "\n").encode()


def answers(served: Served, client: Asking) -> None:
    """Time and processor time of the answers of each page: each another one, and one again and again."""
    print("\n| answer | median | slowest | processor time each | the same again | size |\n|---|---|---|---|---|---|")
    for name, path in QUERIES.items():
        status, body, _ = client.get(path.format(200))
        before = spent(served.process.pid)
        seconds = [client.get(path.format(201 + number))[2] for number in range(ROUNDS)]
        own = (spent(served.process.pid) - before) / ROUNDS
        again = statistics.median(client.get(path.format(200))[2] for _ in range(ROUNDS))
        fit = "" if status == 200 else f" ({status})"
        times = f"{statistics.median(seconds):.3f} s | {max(seconds):.3f} s | {own:.3f} s | {again:.4f} s"
        print(f"| {name}{fit} | {times} | {len(body) / 1e3:.0f} kB |")


def trends(served: Served, client: Asking, item: str) -> None:
    """Zooms of a long record."""
    path = f"/api/v1/trend?source={quote(f'file:{item}')}&width=1200"
    first = client.get(path)
    spans = [(0, 1_000_000), (250_000, 750_000), (400_000, 410_000), (123_456, 234_567), (5000, 5900)]
    before = spent(served.process.pid)
    seconds = [client.get(f"{path}&start={a}&stop={b}")[2] for a, b in spans for _ in range(ROUNDS)]
    own = (spent(served.process.pid) - before) / len(seconds)
    print(
        f"\nTrend of 10^6 x 3: first answer {first[2]:.3f} s ({len(first[1]) / 1e3:.0f} kB, {first[0]}); zooms median ",
        end="",
    )
    print(f"{statistics.median(seconds):.3f} s, slowest {max(seconds):.3f} s, processor time {own:.4f} s each.")


def memory(served: Served, client: Asking, views: int, uploads: int, item: str) -> None:
    """Memory of the page after many views and uploads; the first tenth warms it."""
    paths = [*QUERIES.values(), "/", "/files", f"/trend?source=file:{item}"]
    for number in range(views // 10):
        client.get(paths[number % len(paths)].format(100 + number))
    begun = held(served.process.pid)
    for number in range(views):
        client.get(paths[number % len(paths)].format(100 + number % 900))
    viewed = held(served.process.pid)
    data = csv()
    for number in range(uploads):
        client.drop(f"record {number}.csv", data)
    uploaded = held(served.process.pid)
    said = f"after {views} views {viewed:.0f} MB, and {uploads} uploads {uploaded:.0f} MB"
    print(f"\nMemory of the page: {begun:.0f} MB, {said}.")


@contextmanager
def at_work(client: Asking, data: bytes) -> Iterator[None]:
    """A file is dropped meanwhile."""
    thread = threading.Thread(target=client.drop, args=("large.csv", data))
    thread.start()
    yield
    thread.join()


def crowd(served: Served, clients: int, seconds: float, pause: float, item: str) -> None:
    """Many clients that read at once, while a file comes: plant, files, a trend, and pages that no other reads."""
    paths = [*QUERIES.values(), "/", "/files", f"/api/v1/trend?source=file:{item}&start=1000&stop=200000"]
    found: list[tuple[int, float]] = []
    data = csv(2_500_000)
    until = time.monotonic() + seconds

    def read(number: int) -> None:
        mine = Asking(served)
        while time.monotonic() < until:
            status, _, waited = mine.get(paths[number % len(paths)].format(100 + (7919 * number) % 900))
            found.append((status, waited))
            number += 1
            time.sleep(pause)

    before = spent(served.process.pid)
    with at_work(Asking(served), data):
        threads = [threading.Thread(target=read, args=(101 * number,)) for number in range(clients)]
        for one in threads:
            one.start()
        for one in threads:
            one.join()
    waits = sorted(waited for _, waited in found)
    wrong = sum(status != 200 for status, _ in found)
    own = (spent(served.process.pid) - before) / max(len(found), 1)
    said = f"{clients} clients, {pause:g} s between their questions, for {seconds:g} s, and an upload of"
    print(f"\n{said} {len(data) / 1e6:.0f} MB: {len(found)} answers, {wrong} not 200, ", end="")
    print(f"median {statistics.median(waits):.3f} s, p99 {waits[int(0.99 * len(waits))]:.3f} s, ", end="")
    print(f"processor time {own:.4f} s each.")


def shown(served: Served, item: str) -> None:
    """What a browser measures: first paint of the plant, first draw and zooms of the trend."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        page.goto(served.address)
        paints = [painted(lambda: page.goto(served.base + "/"), page) for _ in range(ROUNDS)]
        page.goto(f"{served.base}/trend?source=file:{item}")
        first = drawn(page)
        zooms = []
        for key in ("+", "+", "+", "PageDown", "+", "-", "PageUp", "+", "Home"):
            page.evaluate("delete document.querySelector('[data-trend]').dataset.milliseconds")
            page.locator("[data-surface]").press(key)
            zooms.append(drawn(page))
        browser.close()
    print(f"\nBrowser: first paint of the plant, median {statistics.median(paints):.0f} ms; ", end="")
    said = f"zooms median {statistics.median(zooms):.0f} ms, slowest {max(zooms)} ms"
    print(f"trend of 10^6 x 3 drawn in {first} ms, {said}.")


def painted(go: Callable[[], object], page) -> float:
    """Milliseconds to the first paint with content."""
    go()
    return page.evaluate(FIRST)


def drawn(page) -> int:
    """Milliseconds from the wish to the picture."""
    root = page.locator("[data-trend][data-milliseconds]")
    root.wait_for()
    return int(root.get_attribute("data-milliseconds"))


def main() -> None:
    """Serve, ask, print."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, usual in (("loops", 26_000), ("views", 1000), ("uploads", 50), ("clients", 50), ("seconds", 20)):
        given.add_argument(f"--{name}", type=int, default=usual)
    given.add_argument(
        "--pauses", type=float, nargs="+", default=[3.0, 0.2, 0.0], help="s between two questions of a client"
    )
    given.add_argument("--store", type=Path, help="made, if it is not there; default: a temporary one")
    asked = given.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = asked.store or Path(folder) / "plant.db"
        if not place.exists():
            with Store(place) as store:
                filled(store, asked.loops, 2)
        item = put_on_desk(Path(folder) / "desk", long_record(), "long.csv")
        served = Served("--store", place, "--keep", Path(folder) / "desk")
        try:
            client = Asking(served)
            print(f"{asked.loops} loops, load of the machine {json.dumps(os.getloadavg())}, {os.cpu_count()} cores")
            answers(served, client)
            trends(served, client, item)
            if CHROMIUM.exists():
                shown(served, item)
            memory(served, client, asked.views, asked.uploads, item)
            for pause in asked.pauses:
                crowd(served, asked.clients, asked.seconds, pause, item)
        finally:
            served.stop()


if __name__ == "__main__":
    main()
