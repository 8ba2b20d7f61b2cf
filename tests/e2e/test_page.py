"""The page in a real browser, served by the real command: plant, loop, file, trend, monitors; by keyboard; dying."""

from __future__ import annotations

import json
import re

import pytest

from lostmotion.evaluate import random_faulty_loop
from lostmotion.web.trend.slot import VENDOR
from tests.support.plant_stores import plant_store
from tests.support.served import ROOT, Served, long_record, put_on_desk
from tests.unit.web.test_monitor import START, event, report

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("page")]  # one worker starts the server

AXE = ROOT / ".cache/web/axe.min.js"
WIDTHS = (390, 1280, 1920)
PATIENCE = 240_000  # ms; machines of tests are busy: 90 s were not enough beside five other processes on two cores
WORK = 540_000  # ms; of the worker of the page, which gives way to everything else (nice 10)


class Site:
    """What is served, and a browser that was let in."""

    def __init__(self, browser, folder):
        self.desk, self.monitor = folder / "desk", folder / "fic1.jsonl"
        self.long = put_on_desk(self.desk, long_record(), "long.csv")
        self.monitor.write_text(
            "".join(json.dumps(one) + "\n" for one in (START, report(100), report(200), event(250)))
        )
        self.served = Served("--store", plant_store(folder), "--keep", self.desk, "--monitor", self.monitor)
        self.browser, self.faults, self.elsewhere = browser, [], []
        context = browser.new_context()
        context.new_page().goto(self.served.address)
        self.state = context.storage_state()
        context.close()

    def open(self, path="/", width=1280, context=None, **settings):
        """A window, whose faults and requests are noted."""
        made = context or self.browser.new_context(
            storage_state=self.state, viewport={"width": width, "height": 900}, **settings
        )
        made.set_default_timeout(PATIENCE)
        page = made.new_page()
        page.on("console", lambda said: said.type == "error" and self.faults.append(f"{page.url}: {said.text}"))
        page.on("pageerror", lambda error: self.faults.append(f"{page.url}: {error}"))
        page.on("request", lambda asked: asked.url.startswith(self.served.base) or self.elsewhere.append(asked.url))
        page.goto(self.served.base + path)
        return page

    @property
    def trend(self):
        return f"/trend?source=file:{self.long}"


@pytest.fixture(scope="module")
def site(browser, tmp_path_factory):
    made = Site(browser, tmp_path_factory.mktemp("page"))
    yield made
    made.served.stop()


@pytest.fixture(autouse=True)
def nothing_wrong(request):
    """No error in the console, and nothing asked of another host."""
    site = request.getfixturevalue("site")
    yield
    faults, site.faults = site.faults, []
    assert (faults, site.elsewhere) == ([], [])


def drawn(page):
    """Wait until the trend has drawn what was asked for; rows shown."""
    root = page.locator("[data-trend][data-milliseconds]")
    root.wait_for()
    return int(root.get_attribute("data-start")), int(root.get_attribute("data-stop"))


def zoomed(page, act):
    """Rows shown after something was done."""
    page.evaluate("delete document.querySelector('[data-trend]').dataset.milliseconds")
    act()
    return drawn(page)


def test_from_the_plant_to_a_loop_and_back(site):
    page = site.open("/?verdict=stiction")
    page.locator(".ranking a", has_text="FIC-1").first.click()
    page.get_by_role("heading", name="FIC-1").first.wait_for()
    assert "stiction" in page.inner_text("main").lower()
    assert drawn(page) == (0, 4000), "the data of the run were read again"
    assert page.locator("[data-trend] svg.plane").count() >= 1
    page.go_back()
    assert "verdict=stiction" in page.url
    page.locator(".ranking a", has_text="FIC-1").first.wait_for()
    page.context.close()


def test_a_million_points_are_zoomed_by_keys_pointer_and_links(site):
    page = site.open(site.trend)
    assert drawn(page) == (0, 1_000_000)
    surface = page.locator("[data-surface]")
    surface.focus()
    assert zoomed(page, lambda: page.keyboard.press("+")) == (250_000, 750_000)
    assert "start=250000" in page.url
    assert zoomed(page, lambda: page.keyboard.press("PageDown")) == (500_000, 1_000_000)
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    said = page.inner_text("[data-cursor]")
    assert re.match(r"2026-03-0\d \d\d:\d\d:\d\d PV \[t/h\] [\d., to]+; SP \[t/h\]", said), said
    box = surface.bounding_box()
    page.mouse.move(box["x"] + 400, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 500, box["y"] + 80, steps=4)
    start, stop = zoomed(page, page.mouse.up)
    assert 500_000 < start < stop < 1_000_000
    assert 20_000 < stop - start < 80_000
    page.reload()
    assert drawn(page) == (start, stop), "the address holds what is shown"
    page.locator("summary", has_text="table").click()
    assert page.locator(".values tbody tr").count() == 12
    assert zoomed(page, lambda: page.locator("[data-step=all]").click()) == (0, 1_000_000)
    assert "start=" not in page.url
    surface.hover()
    surface.focus()
    assert zoomed(page, lambda: page.mouse.wheel(0, -100))[1] < 1_000_000
    page.context.close()


def test_the_trend_is_drawn_by_svg_where_there_is_no_uplot_and_by_links_without_script(site):
    page = site.browser.new_context(storage_state=site.state)
    page.route("**/vendor/*", lambda route: route.fulfill(body="", content_type="text/javascript"))
    page = site.open(site.trend, context=page)
    drawn(page)
    assert page.locator("[data-surface] svg.chart:visible").count() == 2
    page.locator("[data-surface]").focus()
    assert zoomed(page, lambda: page.keyboard.press("+")) == (250_000, 750_000)
    page.keyboard.press("ArrowLeft")
    assert "PV" in page.inner_text("[data-cursor]")
    page.context.close()
    plain = site.open(site.trend, java_script_enabled=False)
    plain.get_by_role("button", name="Zoom in").click()
    assert "start=250000" in plain.url
    plain.wait_for_load_state()  # the address changes before the page is there
    assert plain.locator("svg.chart:visible").count() >= 2
    assert "missing: 2026-03-06" in plain.inner_text(".stretches")
    plain.context.close()


@pytest.mark.skipif(not VENDOR.is_file(), reason="no uPlot: make web")
def test_uplot_draws_where_it_is_there(site):
    page = site.open(site.trend)
    drawn(page)
    assert page.locator("[data-surface] canvas").count() == 2
    assert page.locator("[data-piece=charts]").is_hidden()
    page.context.close()


def test_by_keyboard_alone(site):
    page = site.open("/")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.keyboard.press("Enter")
    for _ in range(80):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.matches('.ranking tbody a')"):
            break
    page.keyboard.press("Enter")
    page.locator("[data-surface].live").wait_for()
    drawn(page)
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.matches('[data-surface]')"):
            break
    ring = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
    assert ring == "solid", "the focus is seen"
    assert zoomed(page, lambda: page.keyboard.press("+")) == (1000, 3000)
    page.context.close()


def test_two_windows_do_not_disturb_each_other(site):
    one = site.open(site.trend)
    other = site.open(site.trend, context=one.context)
    drawn(one), drawn(other)
    one.locator("[data-surface]").focus()
    zoomed(one, lambda: one.keyboard.press("+"))
    other.reload()
    assert drawn(other) == (0, 1_000_000)
    one.context.close()


@pytest.mark.statistics
def test_from_an_own_file_to_a_verdict_in_three_actions(site, tmp_path):
    """Start, drop, read; a reload in the middle changes nothing."""
    loop = random_faulty_loop(4, cause="stiction", process="flow")
    rows = [
        f"{k},{op:.4f},{pv:.4f},{sp:.4f}" for k, (op, pv, sp) in enumerate(zip(loop.op, loop.pv, loop.sp, strict=True))
    ]
    own = tmp_path / "FIC-77 <b>.csv"
    own.write_text("time_s,OP,PV,SP\n" + "\n".join(rows) + "\n")
    page = site.open("/files")
    page.locator("input[type=file]").set_input_files(own)
    page.wait_for_url("**/files/*")
    page.reload()
    page.locator(".verdict", has_text="tiction").wait_for(timeout=WORK)
    assert page.locator("b").count() == page.locator("b").filter(has_not_text="FIC").count()
    assert drawn(page)[1] == len(rows)
    page.context.close()


def test_monitors_tell_what_is_new(site):
    page = site.open("/monitors")
    assert "It moved <b>250</b>." in page.inner_text("main")
    with site.monitor.open("a") as file:
        file.write(json.dumps(report(300, 7.5)) + "\n")
    page.get_by_role("cell", name="7.50").first.wait_for()
    page.context.close()


def pages(site):
    return {
        "plant": "/", "loop": "/loops/FIC-1", "files": "/files", "file": f"/files/{site.long}", "trend": site.trend,
        "monitors": "/monitors", "lost": "/nothing-here",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["plant", "loop", "files", "file", "trend", "monitors", "lost"])
def test_everybody_can_use_it(site, name):
    """No rule of axe-core is broken seriously, dark or light; nothing scrolls sideways at any width."""
    page = site.open(pages(site)[name])
    if name in ("loop", "trend"):
        drawn(page)
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("document.documentElement.scrollWidth") <= width, f"{width} pixels"
    page.set_viewport_size({"width": 640, "height": 450})  # 1280 at 200 %
    assert page.evaluate("document.documentElement.scrollWidth") <= 640
    if name == "lost":
        site.faults = [one for one in site.faults if "404" not in one]  # the browser notes what was asked for
    if not AXE.exists():
        page.context.close()
        pytest.skip("no axe-core: make web")
    page.set_viewport_size({"width": 1280, "height": 900})
    page.evaluate(AXE.read_text())  # not as a tag: the page lets no foreign script in
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
        wrong = [
            (one["id"], [at["target"] for at in one["nodes"]][:3])
            for one in found
            if one["impact"] in ("serious", "critical")
        ]
        assert wrong == [], f"{name}, {scheme}"
    page.context.close()


def test_a_page_that_is_gone_is_told_and_the_command_ends_well(browser, tmp_path):
    site = Site(browser, tmp_path)  # of its own: other tests may come behind this one
    page = site.open(site.trend)
    drawn(page)
    monitors = site.open("/monitors", context=page.context)
    assert site.served.stop() == 0
    page.locator("[data-surface]").focus()
    page.keyboard.press("+")
    page.locator("[role=alert]", has_text="does not answer").wait_for()
    monitors.locator("#news", has_text="does not answer").wait_for()
    faults = [one for one in site.faults if "ERR_CONNECTION" not in one and "ERR_INCOMPLETE" not in one]
    assert (faults, site.elsewhere) == ([], [])
    page.context.close()
