# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a reader does with the viewer of a page, and what must come of it."""
import io
import json
import time

import numpy as np
from PIL import Image

CANVAS = '.viewer [data-part="canvas"]'
SCALE = 0.4  # of the pictures that are looked at: large ones take their time
KEY = 36  # rows of such a picture that the colour key has
PAPER = (255, 255, 255)
HIGHEST = (0x66, 0x3d, 0x9b)  # about the colour at the upper end of the scale


def pixels_of(png):
    """height x width x 3: red, green, blue."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def has_highest(picture):
    """Above the colour key."""
    return (abs(picture[:-KEY] - HIGHEST) <= 40).all(axis=2).any()


def drawn(browser):
    return browser.ask('+document.querySelector(".viewer").dataset.drawn || 0')


def settle(browser):
    """Until nothing is drawn any more."""
    before = -1
    while before != drawn(browser):
        before = drawn(browser)
        time.sleep(0.15)


def shot(browser):
    settle(browser)
    return pixels_of(browser.shot_of(CANVAS, SCALE))


def difference(one, other):
    """Part of the pixels that differ."""
    return (one != other).any(axis=2).mean()


def share_of_tissue(picture, left=0, right=1, bottom=-KEY):
    """Of the part of a picture between two parts of its width, above the colour key. Tissue has the colour map, in any light:
    from sand over red to violet; no grey, which edges, text and ghost have."""
    width = picture.shape[1]
    return (np.ptp(picture[:bottom, int(left * width):int(right * width)], axis=2) > 25).mean()


def set_part(browser, part, value, event="input"):
    browser.ask(f"""(() => {{
      const element = document.querySelector('.viewer [data-part="{part}"]');
      element.value = {json.dumps(value)};
      element.dispatchEvent(new Event("{event}", {{bubbles: true}}));
    }})()""")


def is_ready(browser):
    return browser.wait_until("(f => f && (f.dataset.drawn || f.dataset.failed))(document.querySelector('.viewer'))")


def check_there(browser, num_runs):
    """It draws the bodies of each run, in the colours of the scale."""
    if not is_ready(browser):
        yield "the viewer draws nothing"
        return
    if failed := browser.ask('document.querySelector(".viewer").dataset.failed'):
        yield f"the viewer gives up: {failed}"
        return
    if browser.ask('document.querySelector(".viewer").dataset.plays') == "true":
        yield "the viewer plays by itself although the reader wants less motion"
    picture = shot(browser)
    for k in range(num_runs):
        if (share := share_of_tissue(picture, k / num_runs, (k + 1) / num_runs)) < 0.05:
            yield f"{share:.1%} of the viewer's part {k} has colours of the scale"
    if tuple(picture[2, 2]) != PAPER:
        yield f"the corner of the viewer is {picture[2, 2]}, must be paper"


def check_use(browser, history):
    """It turns, moves, zooms, steps, cuts, and goes through time with the charts."""
    left, top, width, height = browser.box_of(CANVAS)
    middle = (left + width / 2, top + height / 2)
    shown = shot(browser)

    def changes(what, action, least=0.005):
        """Against what is shown; `shown` is then the new picture."""
        nonlocal shown
        before = shown
        action()
        shown = shot(browser)
        found = difference(before, shown)
        return [] if found >= least else [f"{what} changes {found:.2%} of the pixels"]

    def beside(x, y):
        return middle[0] + x, middle[1] + y

    yield from changes("dragging", lambda: browser.drag(middle, beside(120, 30)), 0.1)
    yield from changes("dragging with shift", lambda: browser.drag(middle, beside(90, 0), modifiers=8), 0.1)
    yield from changes("the wheel", lambda: browser.turn_wheel(*middle, -300), 0.05)
    yield from changes("Reset view", lambda: browser.ask("document.querySelector('[data-part=home]').click()"), 0.02)
    for key in ("ArrowLeft", "ArrowUp", "+"):
        yield from changes(f"the key {key}", lambda key=key: browser.press(key, text=key if len(key) == 1 else None))
    yield from changes("the key 0", lambda: browser.press("0", text="0"), 0.005)

    # two fingers that go apart
    def pinch():
        browser.touch("touchStart", beside(-40, 0), beside(40, 0))
        browser.touch("touchMove", beside(-120, 0), beside(120, 0))
        browser.touch("touchEnd")
    home = share_of_tissue(shown)
    pinch()
    if not (near := share_of_tissue(shot(browser))) > 1.2 * home:
        yield f"a pinch brings the tissue from {home:.1%} to {near:.1%} of the picture"
    browser.press("0", text="0")

    # time: by the slider, by keys, and where the charts are
    step = 'document.querySelector(".viewer").dataset.step'
    set_part(browser, "slider", 0)
    if (at := browser.ask(step)) != "0":
        yield f"at the beginning of the slider stands step {at}"
    begin = shot(browser)
    if has_highest(begin):
        yield "before the first step there is the colour of the largest strain"
    browser.press(".", text=".")
    if not 0 < int(browser.ask(step)) < 10:
        yield f"the key of a full stop goes to step {browser.ask(step)}"
    set_part(browser, "slider", 1000)
    if (at := browser.ask(step)) != history[-1]["step"]:
        yield f"at the end of the slider stands step {at}"
    end = shot(browser)
    if difference(begin, end) < 0.02:
        yield "the first and the last state look alike"
    if not has_highest(end):
        yield "in the last state there is no colour of the largest strain"
    legend = browser.ask('document.querySelector("figure.chart figcaption").textContent')
    if f"step {history[-1]['step']}," not in legend:
        yield f"the charts do not follow the viewer: '{legend}'"
    time_of_chart = float(history[len(history) // 2]["time"])
    browser.ask(f'document.dispatchEvent(new CustomEvent("hexaplast:time", {{detail: {{time: {time_of_chart}}}}}))')
    if abs(int(browser.ask(step)) - len(history) // 2) > 1:
        yield f"the viewer does not follow the charts: step {browser.ask(step)}"

    # what can be switched, one after the other
    shown = shot(browser)
    for name in browser.ask('[...document.querySelectorAll(".viewer [data-shows]")].map(box => box.dataset.shows)'):
        toggle = f"document.querySelector('[data-shows={name}]').click()"
        yield from changes(f"switching {name}", lambda toggle=toggle: browser.ask(toggle), 1e-4)
    yield from changes("another field", lambda: set_part(browser, "field", "stress", "change"), 0.01)
    yield from changes("a cut", lambda: set_part(browser, "cut", "z", "change"), 0.01)
    if not browser.ask(f"document.querySelector('{CANVAS}').getAttribute('aria-label')"):
        yield "the viewer has no name for those who cannot see it"
    focused = browser.ask('getComputedStyle(document.activeElement).outlineStyle')
    if focused == "none":
        yield "the viewer does not show that it is chosen"


def check_play(browser):
    """It plays once by itself, from the beginning, for a reader who has nothing against motion."""
    step = '+document.querySelector(".viewer").dataset.step'
    if not browser.wait_until("document.querySelector('.viewer')?.dataset.plays === 'true'"):
        yield "the viewer does not play by itself"
        return
    first = browser.ask(step)
    if not browser.wait_until(f"{step} > {first}"):
        yield "the viewer plays, and stays where it is"
    browser.ask("document.querySelector('[data-part=play]').click()")
    if browser.ask("document.querySelector('.viewer').dataset.plays") != "false":
        yield "the viewer cannot be stopped"


def num_changes(browser, selector, enough, shots):
    """How often what an element shows changes within so many halves of a second; of more than enough one is not counted."""
    changes, before = 0, browser.shot_of(selector)
    for _ in range(shots):
        if changes >= enough:
            break
        time.sleep(0.5)
        now = browser.shot_of(selector)
        changes += now != before
        before = now
    return changes


LEGEND = """[...document.querySelectorAll('[data-part="label"] b')].map(entry => [
  entry.textContent.trim(), getComputedStyle(entry.querySelector("i")).backgroundColor.match(/[0-9]+/g).map(Number)])"""


def check_regions(browser, names):
    """The pictures of the run show regions: a cut, which has no light, has their colours and no others between them."""
    is_ready(browser)
    legend = browser.ask(LEGEND)
    if [name for name, _ in legend] != names:
        yield f"regions {legend}, must be {names}"
    set_part(browser, "cut", "z", "change")
    for within in ("", "1"):
        set_part(browser, "within", within, "change")
        picture = shot(browser)[:-KEY]
        for number, (name, colour) in enumerate(legend):
            count = (abs(picture - colour) <= 2).all(axis=2).sum()
            if (count >= 30) != (number == 1 or not within):
                yield f"{count} pixels have the colour of {name} where '{within}' is shown"


def check_frame(browser, moves):
    """In the frame of a notebook, which the browser keeps apart from its page: it plays as it does elsewhere."""
    changes = num_changes(browser, "iframe", 4, 10 if moves else 6)
    if moves and changes < 4:
        yield f"in a frame the viewer does not play: it changes {changes} times"
    if not moves and changes > 2:  # once it is laid out, and once it is drawn
        yield f"in a frame the viewer plays for a reader who wants no motion: it changes {changes} times"
