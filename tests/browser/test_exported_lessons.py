"""The lessons as a reader has them without a kernel: exported, far from any network."""

from pathlib import Path

import pytest

LESSONS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
PLAYERS = {"00": 1, "01": 0, "02": 3, "03": 2, "04": 2, "05": 1, "06": 0, "07": 2}


def each(paths):
    """All of them under the mark exhaustive, else three."""
    return [
        pytest.param(path, id=path.stem, marks=() if path.stem[:2] in ("00", "05", "07") else pytest.mark.exhaustive)
        for path in paths
    ]


@pytest.mark.parametrize("path", each(LESSONS))
def test_an_exported_lesson_plays(path, static_page, seen, tmp_path):
    from nbconvert import HTMLExporter

    html = tmp_path / "lesson.html"
    html.write_text(HTMLExporter(embed_images=True).from_filename(path)[0], encoding="utf-8")
    page = static_page(html)
    stills = page.locator(".fem-still, .fem-player")
    players, empty = page.locator(".fem-player"), page.locator(".fem-still:not(:has(.fem-data))")
    for k in range(stills.count()):
        stills.nth(k).scroll_into_view_if_needed()
        page.wait_for_function(
            "k => !document.querySelectorAll('.fem-still, .fem-player')[k].querySelector('.fem-data')", arg=k
        )
    assert (players.count(), empty.count()) == (PLAYERS[path.stem[:2]], stills.count() - players.count())
    for k in range(players.count()):
        player = players.nth(k)
        last = player.locator(".fem-where").text_content().split(",")[0].rpartition(" ")[2]
        for key, step in (("ArrowRight", "1"), ("End", last), ("Home", "0")):
            player.press(key)
            assert player.locator(".fem-where").text_content().startswith(f"step {step} of {last}, ")
    # nbconvert's page asks a content network for its formulas.
    assert [error for error in seen.errors if "ERR_" not in error and "require" not in error] == []
