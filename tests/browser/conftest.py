import importlib.util
import os
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import pytest

CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]
SCREEN = {"width": 1280, "height": 900}
ELSEWHERE = re.compile(r"^(https?|wss?)://(?!127\.0\.0\.1[:/])")
OUTCOME = pytest.StashKey()


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
        required = os.environ.get("FEM_MESH_BROWSER") == "required"
        (pytest.fail if required else pytest.skip)(f"tests in a browser: {lack}")


@dataclass
class Seen:
    """What went on in a test's pages: their errors, and the requests that wanted to leave this machine."""

    errors: list[str] = field(default_factory=list)
    foreign: list[str] = field(default_factory=list)
    console: list[str] = field(default_factory=list)

    def attend(self, context):
        context.on("console", self._said)
        context.on("weberror", lambda error: self.errors.append(error.error.stack or str(error.error)))
        context.route(ELSEWHERE, self._refuse)
        context.route_web_socket(ELSEWHERE, lambda socket: self.foreign.append(socket.url))

    def _said(self, message):
        self.console.append(f"{message.type}: {message.text}")
        if message.type == "error":
            self.errors.append(message.text)

    def _refuse(self, route):
        self.foreign.append(route.request.url)
        route.abort()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if call.when == "call":
        item.stash[OUTCOME] = report
    return report


def failed(item):
    report = item.stash.get(OUTCOME, None)
    return report is not None and report.failed


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


@pytest.fixture
def seen(request):
    """Errors and foreign requests of all pages of a test; printed when it fails."""
    seen = Seen()
    yield seen
    if failed(request.node):
        for name in ("errors", "foreign", "console"):
            print(f"\n{name} in the browser:", *getattr(seen, name), sep="\n  ")


@pytest.fixture
def contexts(request, browser, seen, tmp_path):
    """Makes browser contexts that are attended to, and closes them; pages of a test that failed are pictured."""
    made = []

    def make(**options):
        context = browser.new_context(**{"viewport": SCREEN} | options)
        context.set_default_timeout(20_000)
        seen.attend(context)
        made.append(context)
        return context

    yield make
    if failed(request.node):
        for k, page in enumerate(page for context in made for page in context.pages):
            page.screenshot(path=tmp_path / f"page{k}.png")
            print(f"\n{page.url} looked like {tmp_path}/page{k}.png")
    for context in made:
        context.close()


@pytest.fixture
def fresh_lab(lab):
    yield lab
    lab.reset()


@pytest.fixture
def page(fresh_lab, contexts):
    """An empty page of a fresh browser context that knows the lab: ``open_notebook(page, [...])`` comes next."""
    key = {"Authorization": f"token {fresh_lab.token}"}
    return contexts(base_url=fresh_lab.url, extra_http_headers=key).new_page()


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
