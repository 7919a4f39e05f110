#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Opens the pages that runs leave in a real browser: report_in_browser.py HEXAPLAST SCENE DIRECTORY [PICTURES]

Runs the scene twice into DIRECTORY, compares the runs, and looks at report and comparison in headless Chromium, at the
width of a desk's screen, light, and of a phone, dark. Fails where the browser has something to say, where a page asks
for anything but itself, where a chart or picture is not there to be seen, where a page scrolls sideways, and where a
chart does not tell the numbers of history.csv under the pointer, and where the viewer does not do what it is asked for
(viewer_checks.py). With a folder PICTURES, what was seen is kept there.

Ends with 77, which ctest counts as skipped, where there is no Chromium (scripts/install_packages --test)."""
import csv
import html
import pathlib
import shutil
import subprocess
import sys
import tempfile

import browser as chromium
import viewer_checks

SKIPPED = 77
SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
VIEWS = {"desk": (1280, "light"), "phone": (390, "dark")}  # [pixels] of the width, and the scheme
LEAST_TEXT = 9  # [pixels] of the height of letters in charts


CHARTS = """[...document.querySelectorAll("figure.chart")].map(figure => {
  const box = element => { const b = element.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; };
  return {box: box(figure.querySelector("svg")),
          curves: [...figure.querySelectorAll("polyline")].map(box),
          texts: [...figure.querySelectorAll("svg text")].map(text => box(text)[3]),
          legend: figure.querySelector("figcaption").textContent};
})"""


def complaints_of(browser):
    """What the browser says of the page on its own."""
    for event in browser.events:
        method, what = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            yield f"exception: {what['exceptionDetails']}"
        elif method == "Runtime.consoleAPICalled":
            yield f"console: {what['args']}"
        elif method == "Log.entryAdded":
            yield f"log: {what['entry']['text']}"
        elif method == "Network.requestWillBeSent" and not what["request"]["url"].startswith("data:"):
            if what["request"]["url"] != what["documentURL"]:
                yield f"asks for {what['request']['url']}"


def look_at(browser, page, width):
    """What is wrong with the page that is open."""
    yield from complaints_of(browser)
    scroll_width = browser.ask("document.documentElement.scrollWidth")
    if scroll_width > width:
        yield f"scrolls sideways: {scroll_width} pixels wide"
    charts = browser.ask(CHARTS)
    if len(charts) < 6:
        yield f"{len(charts)} charts, must be six at least"
    for number, chart in enumerate(charts):
        left, _, chart_width, height = chart["box"]
        if left < 0 or left + chart_width > width or chart_width < 250 or height < 120:
            yield f"chart {number} is not there to be seen: {chart['box']}"
        if not chart["curves"] or any(curve[2] < chart_width / 2 for curve in chart["curves"]):
            yield f"chart {number} has no curves over its width: {chart['curves']}"
        if min(chart["texts"]) < LEAST_TEXT:
            yield f"chart {number} has letters of {min(chart['texts']):.1f} pixels"
    if not browser.ask("[...document.images].every(image => image.naturalWidth > 0)"):
        yield "a picture cannot be shown"


def check_pointer(browser, history):
    """The chart of elongation against history.csv, at the middle of its run."""
    browser.ask('document.querySelector("figure.chart").scrollIntoView()')
    left, top, width, height = browser.ask(CHARTS)[0]["box"]
    frame = browser.ask('JSON.parse(document.querySelector("figure.chart script").textContent).frame')
    scale = width / browser.ask('document.querySelector("figure.chart svg").viewBox.baseVal.width')
    browser.point_at(left + scale * (frame[0] + frame[2] / 2), top + height / 2)
    legend = browser.ask(CHARTS)[0]["legend"]

    row = history[len(history) // 2]
    for name, column in (("current", "current_elongation"), ("plastic", "plastic_elongation")):
        value = float(f"{100 * float(row[column]):.5g}")
        if f"{name} {value:g} %" not in " ".join(legend.split()):
            yield f"under the pointer: '{legend}', must have {name} {value:g} % of step {row['step']}"
    if f"step {row['step']}," not in legend:
        yield f"under the pointer: '{legend}', must have step {row['step']}"
    browser.point_at(1, 1)
    if "step" in browser.ask(CHARTS)[0]["legend"]:
        yield "the values stay when the pointer has gone"


def check_click(browser):
    """A picture that is clicked is shown large, and small again."""
    width = '[...document.querySelectorAll(".pictures img")].map(image => image.getBoundingClientRect().width)[0]'
    click = 'document.querySelector(".pictures figure").click()'
    small = browser.ask(width)
    browser.ask(click)
    large = browser.ask(width)
    browser.ask(click)
    if not large > 1.5 * small or browser.ask(width) != small:
        yield f"a picture of {small} pixels is {large} wide after a click"


def main():
    program = chromium.program()
    if not program:
        print("no Chromium: the pages are not looked at")
        return SKIPPED
    hexaplast, scene, directory = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    pictures = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)

    report = directory / "a" / "report.html"
    subprocess.run([hexaplast, "run", scene, "--steps", "60", "--frames", "2", "--quiet", "--out", report.parent],
                   check=True)
    with open(report.parent / "history.csv") as file:
        history = list(csv.DictReader(file))
    comparison = directory / "comparison.html"
    subprocess.run([hexaplast, "run", scene, "--steps", "50", "--frames", "0", "--quiet", "--out", directory / "b",
                    "--set", "bar/material.yieldStress=250"], check=True)
    subprocess.run([hexaplast, "compare", report.parent, directory / "b", "--out", comparison], check=True,
                   stdout=subprocess.DEVNULL)

    # as python/hexaplast/_notebook.py puts it into a notebook
    frame = directory / "frame.html"
    frame.write_text(f'<!DOCTYPE html><iframe srcdoc="{html.escape(report.read_text())}" sandbox="allow-scripts" '
                     'style="width: 100%; height: 800px; border: 0"></iframe>')

    regions = directory / "regions" / "report.html"
    subprocess.run([hexaplast, "run", SOURCE / "scenes/liver_tumour.scn", "--steps", "1", "--frames", "0", "--quiet",
                    "--field", "region", "--out", regions.parent], check=True)

    wrong = []
    # processes of the browser outlive it by a moment, and still write then
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = chromium.Browser(program, profile)
        for page in (report, comparison):
            for device, (width, scheme) in VIEWS.items():
                browser.open(page, width, scheme)
                found = list(viewer_checks.check_there(browser, 1 if page is report else 2))
                found += look_at(browser, page, width)
                if pictures:
                    browser.picture(pictures / f"{page.stem}_{device}.png")
                if page is report:
                    found += check_pointer(browser, history)
                    if device == "desk":
                        found += check_click(browser)
                    if device == "desk" and not found:
                        found += viewer_checks.check_use(browser, history)
                    found += complaints_of(browser)
                wrong += [f"{page.name}, {device}: {what}" for what in found]
        browser.open(report, *VIEWS["desk"], moves=True)
        wrong += [f"{report.name}, moving: {what}" for what in viewer_checks.check_play(browser)]
        browser.open(frame, *VIEWS["desk"])
        wrong += [f"{frame.name}, moving: {what}" for what in viewer_checks.check_frame(browser, True)]
        browser.open(regions, *VIEWS["desk"])
        found = list(viewer_checks.check_regions(browser, ["in no region", "tumour", "vessel"]))
        wrong += [f"{regions.name} with regions: {what}" for what in found + list(complaints_of(browser))]
        browser.close()
    # what is set for a page does not reach its frames: the browser itself wants no motion
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = chromium.Browser(program, profile, ["--force-prefers-reduced-motion"])
        browser.open(frame, *VIEWS["desk"])
        wrong += [f"{frame.name}: {what}" for what in viewer_checks.check_frame(browser, False)]
        browser.close()
    print("\n".join(wrong) or "nothing to complain of")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
