import importlib.util
import os
import re
import shutil
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from .notebook import close_notebooks, is_tidy
from .shared import desk

CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]
SCREEN = {"width": 1280, "height": 900}
# What JupyterLab says of its own questions to a kernel that is stopped.
OF_THE_LAB = re.compile("Canceled future for (create_subshell|debug)_request")
ELSEWHERE = re.compile(r"^(https?|wss?)://(?!127\.0\.0\.1[:/])")


def chromium():
    return next(filter(None, map(shutil.which, CHROMIUM)), None)


def missing():
    """What these tests lack on this machine, or nothing."""
    if chromium() is None:
        return f"no Chromium: none of {', '.join(CHROMIUM)} is a command here"
    modules = ("playwright", "jupyterlab", "anywidget")
    return ", ".join(f"no {module} in this environment" for module in modules if not importlib.util.find_spec(module))


@pytest.fixture(scope="package", autouse=True)
def equipped():
    """Without a browser these tests are skipped; where FEM_MESH_BROWSER=required says so, they fail."""
    if lack := missing():
        if os.environ.get("FEM_MESH_BROWSER") == "required":
            pytest.fail(f"tests in a browser: {lack}")
        pytest.skip(f"tests in a browser: {lack}")


@dataclass
class Seen:
    """What went on in a test's pages: their errors, and the requests that wanted to leave this machine."""

    errors: list[str] = field(default_factory=list)
    foreign: list[str] = field(default_factory=list)
    console: list[str] = field(default_factory=list)

    def attend(self, context):
        context.on("console", self._said)
        context.on("weberror", lambda error: self._fail(error.error.stack or str(error.error)))
        context.route(ELSEWHERE, self._refuse)
        context.route_web_socket(ELSEWHERE, lambda socket: self.foreign.append(socket.url))

    def clear(self):
        for told in (self.errors, self.foreign, self.console):
            told.clear()

    def _said(self, message):
        self.console.append(f"{message.type}: {message.text}")
        if message.type == "error":
            self._fail(message.text)

    def _fail(self, text):
        if not OF_THE_LAB.search(text):
            self.errors.append(text)

    def _refuse(self, route):
        self.foreign.append(route.request.url)
        route.abort()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Of a test that failed: what its pages said, and what they looked like."""
    report = yield
    known = getattr(item, "funcargs", {})
    if report.failed and "browser" in known:
        if room := known.get("room"):
            room.spoilt = True
        told = [f"{name}: {line}" for name in ("errors", "foreign", "console") for line in getattr(known["everything"], name)]
        for k, page in enumerate(page for context in known["browser"].contexts for page in context.pages):
            path = item.config.cache.mkdir("browser") / f"{re.sub('[^a-z_]', '', item.name)}_{k}.png"
            page.screenshot(path=path)
            told.append(f"{page.url} looked like {path}")
        report.sections.append(("the browser", "\n".join(told)))
    return report


@pytest.fixture(scope="package")
def lab(equipped, tmp_path_factory):
    """A JupyterLab that runs as long as this package's tests do."""
    from .server import Server

    server = Server(tmp_path_factory.mktemp("lab"))
    try:
        server.wait()
        yield server
    finally:
        server.stop()


@pytest.fixture(scope="package")
def browser(equipped):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="package")
def everything():
    return Seen()


@pytest.fixture
def seen(everything):
    """Errors and foreign requests of all pages of a test."""
    everything.clear()
    return everything


@pytest.fixture
def contexts(browser, seen):
    """Makes browser contexts that are attended to, and closes them."""
    made = []

    def make(**options):
        made.append(new_context(browser, seen, **options))
        return made[-1]

    yield make
    for context in made:
        context.close()


def new_context(browser, seen, **options):
    context = browser.new_context(**{"viewport": SCREEN} | options)
    context.set_default_timeout(20_000)
    seen.attend(context)
    return context


class Room:
    """A page with the lab in it, for one notebook after the other: the lab takes seconds to load, a notebook does not."""

    def __init__(self, lab, browser, seen):
        self.lab, self.browser, self.seen = lab, browser, seen
        self.page, self.taken, self.spoilt = None, False, False

    @contextmanager
    def notebook(self):
        """The page, without a notebook: ``open_notebook(page, [...])`` comes next."""
        assert not self.taken, "one notebook at a time"
        self.taken = True
        self.seen.clear()
        if self.page is None:
            key = {"Authorization": f"token {self.lab.token}"}
            context = new_context(self.browser, self.seen, base_url=self.lab.url, extra_http_headers=key)
            self.page = context.new_page()
        try:
            yield self.page
        finally:
            self.taken = False
            if self.spoilt or not is_tidy(self.page):
                self.page.context.close()
                self.page, self.spoilt = None, False
            else:
                close_notebooks(self.page)
            self.lab.reset()


@pytest.fixture(scope="package")
def room(lab, browser, everything):
    return Room(lab, browser, everything)


@pytest.fixture
def page(room, seen):
    """The lab's page, for this test alone."""
    with room.notebook() as page:
        yield page


@pytest.fixture(scope="module")
def opened(room, request):
    """The notebook that a module's tests share: the cells in its ``NOTEBOOK``, run."""
    with desk(room, *request.module.NOTEBOOK) as opened:
        yield opened


@pytest.fixture
def static_page(contexts):
    """Opens a file in a page without network: ``static_page(path, scripts=False, color_scheme="dark")``."""

    def open_static(path: Path, *, scripts: bool = True, **options):
        context = contexts(java_script_enabled=scripts, **options)
        context.set_offline(True)
        page = context.new_page()
        page.goto(Path(path).absolute().as_uri())
        return page

    return open_static
