"""Reports in a real browser: no sideways scrolling, nothing fetched, nothing hostile runs, script only helps."""

from __future__ import annotations

import pytest

from lostmotion.report.plant import plant_report
from tests.support.plant_rows import HOSTILE, plant

pytestmark = pytest.mark.long

WIDTHS = (390, 1280, 1920)


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "plant.html"
    path.write_text(plant_report(plant(HOSTILE)), encoding="utf-8")
    return path.as_uri()


def test_nothing_scrolls_sideways_and_nothing_is_fetched_or_run(browser, address):
    page = browser.new_page()
    said, asked = [], []
    for event in ("console", "pageerror", "dialog"):
        page.on(event, lambda what: said.append(str(what)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert (said, asked) == ([], [address])
    page.close()


def test_sorting_and_filtering_by_keyboard(browser, address):
    page = browser.new_page()
    page.goto(address)
    page.locator("#all summary").click()
    rows = page.locator("#all tbody tr")
    assert rows.count() == 5
    page.locator("#all thead button").nth(6).focus()
    page.keyboard.press("Enter")
    assert page.locator("#all thead th").nth(6).get_attribute("aria-sort") == "ascending"
    assert rows.last.locator("td").first.inner_text() == "1"  # least priority first
    page.locator("#all input").fill("stiction")
    assert page.locator("#all [role=status]").inner_text() == "1 of 5 shown"
    assert page.locator("#all tbody tr:visible").count() == 1
    page.close()


def test_without_script_all_of_it_is_there(browser, address):
    page = browser.new_context(java_script_enabled=False).new_page()
    page.goto(address)
    assert page.locator("#ranking tbody tr:visible").count() == 1
    assert page.locator("#ranking button").count() == 0
    page.locator("a[href='#loop-1']").first.click()
    assert page.url.endswith("#loop-1")
    page.close()


def test_a_link_opens_the_folded_loop_and_the_page_is_short(browser, address):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(address)
    assert page.evaluate("document.documentElement.scrollHeight") < 4000
    loop = page.locator("#loop-1")
    assert not loop.is_visible()
    page.locator("a[href='#loop-1']").first.click()
    loop.wait_for(state="visible")
    page.goto(address + "#loop-2")
    page.reload()
    assert page.locator("#loop-2").is_visible()
    page.close()


def test_it_prints_on_a4(browser, address):
    page = browser.new_page()
    page.goto(address)
    printed = page.pdf(prefer_css_page_size=True)
    assert printed.startswith(b"%PDF")
    assert b"/MediaBox [0 0 594" in printed or b"/MediaBox [0 0 595" in printed
    page.close()
