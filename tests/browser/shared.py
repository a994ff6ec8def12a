"""A notebook that several tests share, since opening one takes seconds; and its widgets as a reader meets them."""

import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from .notebook import cell, js, open_notebook, python, run_all, wait_until

PATIENCE = 10_000  # milliseconds that a text may take to come


@dataclass
class Desk:
    """A notebook that was run, with what its page said."""

    page: Any
    seen: Any

    def ask(self, expression, code=""):
        return python(self.page, expression, code=code)

    def do(self, code):
        python(self.page, "None", code=code)

    def begin_anew(self, code):
        """Run code to begin a test with, when all that the page had to tell is told: of changes in a rush the last
        waits for the answer to the first."""
        self.seen.errors.clear()
        self.do("None")
        self.do(code)

    def widget(self, i, kind, view=None):
        """The widget in the output of the i-th cell."""
        view = (view or Widget)(self, cell(self.page, i).locator(f".jp-OutputArea-output .fem-{kind}:visible"))
        view.root.wait_for()
        view.root.scroll_into_view_if_needed()
        return view

    def comes_true(self, expression, code=""):
        """Wait until something is true in Python: part of what the page tells is on its way, or has to be compiled for."""
        end = time.monotonic() + 120
        while time.monotonic() < end:
            if python(self.page, f"bool({expression})", code=code) == "True":
                return
            self.page.wait_for_timeout(50)
        raise AssertionError(f"not true in Python: {expression}")

    def nothing_wrong(self):
        assert (self.seen.errors, self.seen.foreign) == ([], []), (self.seen.errors, self.seen.foreign)


@dataclass
class Widget:
    """One view of a widget."""

    desk: Desk
    root: Any

    def __getattr__(self, name):
        """``widget.caption`` is the element of class ``fem-caption``."""
        return self.root.locator(f".fem-{name}")

    def button(self, name):
        return self.root.get_by_role("button", name=name, exact=True)

    def press(self, *keys):
        """Type, with the focus on the widget itself."""
        self.root.focus()
        for key in keys:
            self.desk.page.keyboard.press(key)

    def named_focus(self):
        """The label of the element with the focus, if it is one of the widget's."""
        label = "document.activeElement.getAttribute('aria-label')"
        return self.root.evaluate(f"root => root.contains(document.activeElement) && {label}")

    def reads(self, name, text):
        """Wait until the element of class ``fem-name`` has this text (a string, or a pattern)."""
        expect(getattr(self, name)).to_have_text(text, timeout=PATIENCE)


def expect(locator):
    from playwright.sync_api import expect

    return expect(locator)


def is_picture(still, words):
    """A picture that stands for a widget is there, and what it shows is written, for readers and as its ``alt``."""
    picture = still.get_by_role("img")
    assert words in picture.get_attribute("alt")
    assert picture.evaluate("img => img.decode().then(() => img.naturalWidth > 300)")
    assert still.get_by_text(words).first.is_visible()


@dataclass
class Plane:
    """A canvas that shows a box (left, right, bottom, top) of the plane, and the pointer on it."""

    page: Any
    canvas: Any
    box: tuple[float, float, float, float]

    def at(self, x, y):
        """Where a point of the plane is on the canvas, in pixels."""
        left, right, bottom, top = self.box
        frame = self.canvas.bounding_box()
        scale = min(frame["width"] / (right - left), frame["height"] / (top - bottom))
        return {
            "x": frame["width"] / 2 + scale * (x - (left + right) / 2),
            "y": frame["height"] / 2 - scale * (y - (bottom + top) / 2),
        }

    def click(self, x, y, **how):
        self.canvas.click(position=self.at(x, y), **how)

    def move(self, x, y):
        """Move the pointer there."""
        at, frame = self.at(x, y), self.canvas.bounding_box()
        self.page.mouse.move(frame["x"] + at["x"], frame["y"] + at["y"], steps=4)

    @contextmanager
    def held(self, x, y):
        """While the pointer that was pressed there stays pressed."""
        self.move(x, y)
        self.page.mouse.down()
        yield
        self.page.mouse.up()


@contextmanager
def desk(room, *cells):
    """Open a notebook with these cells, and run it."""
    with room.notebook() as page:
        open_notebook(page, cells)
        run_all(page)
        yield Desk(page, room.seen)


@contextmanager
def commands_asked(page):
    """A list of the lab's commands that keys call; none of them is carried out."""
    asked = []
    page.evaluate("() => { window.asked = []; jupyterapp.commands.execute = async id => { asked.push(id); }; }")
    try:
        yield asked
    finally:
        asked += page.evaluate("() => { delete jupyterapp.commands.execute; return asked; }")


LOUD = """d d a b x v z y m r 1 j k 0 0 i i o c s l Shift+M Shift+L ArrowUp ArrowDown ArrowLeft Enter Space
    Delete Escape Shift+Enter Control+Enter Control+s"""  # each means something to the lab


def no_key_reaches_the_notebook(widget, places):
    """Type keys with the focus at each of these places in a widget: the lab hears none of them."""
    page, called = widget.desk.page, {}
    for place in places:
        node = widget.root.locator(place).first if place else widget.root
        node.focus()
        before = state(page)
        with commands_asked(page) as asked:
            for key in LOUD.split():
                node.focus()
                page.keyboard.press(key)
        assert state(page) == before, f"changed by keys at {place or 'the root'}"
        called[place] = asked
    assert not any(called.values()), called


def state(page):
    """Of the notebook: its cells' texts, the mode, and which cell is the active one."""
    sources = "notebook.widgets.map(cell => cell.model.sharedModel.getSource())"
    return js(page, f"() => [{sources}, notebook.mode, notebook.activeCellIndex]")


def until(page, body, argument=None):
    return wait_until(page, body, argument, seconds=PATIENCE / 1000)
