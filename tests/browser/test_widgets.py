"""What the player and both playgrounds have in common in JupyterLab: keys, names, help, themes."""

import re

import pytest

from .flips import CELLS
from .notebook import set_theme, wait_until
from .shared import no_key_reaches_the_notebook

# Of each kind: a word that its help has, and where else than on its root the focus may be.
KINDS = {
    "player": ("next step of this kind", ["button[aria-label='step forward']", "select", ".fem-scrubber"]),
    "playground": ("add a point at the cross", [".fem-plane", "button[aria-label='fit the view']"]),
    "domain-playground": ("grid", ["input", ".fem-bar select", ".fem-bar button"]),
}
CONTROLS = "button:enabled:visible, select:visible, input:visible"
DARK = """() => [...document.querySelectorAll(".fem-player, .fem-playground, .fem-domain-playground")]
    .map(root => root.classList.contains("fem-dark")).join()"""


NOTEBOOK = [*CELLS, "fm.DomainPlayground(fm.l_shape())"]


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.fixture
def widget(opened, kind):
    opened.seen.clear()
    yield opened.widget(2 + list(KINDS).index(kind), kind)
    opened.nothing_wrong()


def names(nodes):
    return [node.get_attribute("aria-label") for node in nodes.all()]


def test_no_key_reaches_the_notebook_wherever_the_focus_is_in_it(widget, kind):
    no_key_reaches_the_notebook(widget, ["", *KINDS[kind][1]])


def test_tab_reaches_all_that_can_be_pressed_and_each_has_a_name_of_its_own(widget):
    widget.press("ArrowRight", "ArrowRight")
    widget.root.focus()
    reached = []
    for _ in range(40):
        widget.desk.page.keyboard.press("Tab")
        if not (name := widget.named_focus()):
            break
        reached.append(name)
    wanted = names(widget.root.locator(CONTROLS))
    assert [name for name in reached if name in wanted] == wanted
    assert all(wanted)
    assert len(set(wanted)) == len(wanted)


def test_a_screen_reader_is_told_what_it_is_and_where_news_will_come(widget, kind):
    assert widget.root.get_attribute("role") == "group"
    assert widget.root.get_attribute("aria-label").startswith(kind.replace("-", " "))
    assert widget.root.locator("[role=status][aria-live=polite]").count() > 0
    assert re.search(r"\d", widget.root.locator("canvas").first.get_attribute("aria-label"))


def test_help_lists_the_keys_and_goes_away_again(widget, kind):
    assert widget.help.is_hidden()
    for close in (lambda: widget.press("?"), lambda: widget.press("Escape"), widget.help.click):
        widget.press("?")
        assert KINDS[kind][0] in widget.help.text_content()
        assert widget.help.is_visible()
        close()
        assert widget.help.is_hidden()
    widget.button("help").click()
    assert widget.help.is_visible()
    widget.press("Escape")


def test_the_theme_of_the_lab_is_theirs(opened):
    for theme in ("Dark", "Light"):
        set_theme(opened.page, f"JupyterLab {theme}")
        dark = ",".join([str(theme == "Dark").lower()] * 4)
        wait_until(opened.page, f"dark => ({DARK})() === dark", dark, seconds=10)
    opened.nothing_wrong()
