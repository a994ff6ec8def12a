"""The domain playground's page: drawn on by pointer, and compared with what Python has."""

import ast
from contextlib import contextmanager

from .shared import Plane, Widget

SETUP = """
import fem_mesh as fm
pg = fm.DomainPlayground()
pg
"""
RESET = """
pg.domain = fm.square()
pg.domain = None
pg.min_angle, pg.size, pg.spots, pg.encroachment = 20, None, [], "lens"
"""
PAGE = (0, 6, 0, 4)  # left, right, bottom, top of an empty one
PIXEL = 6 / 500  # at least
L_SHAPE = [(1, 1), (5, 1), (5, 2), (2, 2), (2, 3.5), (1, 3.5)]


class Board(Widget):
    """A domain playground that shows an empty page."""

    @property
    def plane(self):
        return Plane(self.desk.page, self.root.locator(".fem-sheet canvas"), PAGE)

    def draw(self, corners, close=True):
        """Click corner after corner, and the first one again."""
        for x, y in [*corners, *corners[:close]]:
            self.plane.click(x, y)

    def corners(self):
        return ast.literal_eval(self.desk.ask("[] if pg.domain is None else pg.domain.points.tolist()"))

    def has_corners(self, n):
        """Wait until so many corners are in loops that are closed."""
        self.desk.comes_true(f"pg.domain is not None and len(pg.domain.points) == {n}")

    def has_corner(self, k, x, y, near=PIXEL):
        self.desk.comes_true(f"abs(pg.domain.points[{k}] - ({x}, {y})).max() < {near}")

    def labelled(self, name):
        return self.root.get_by_label(name, exact=True)

    def control(self, name):
        """A button whose name goes on."""
        return self.root.get_by_role("button", name=name).first

    def reads_as_in_python(self):
        """Wait until the page tells of the mesh that Python has."""
        facts = "pg.mesh and (len(pg.mesh.points), len(pg.mesh.triangles), round(pg.mesh.min_angle, 1))"
        for _ in range(100):
            points, triangles, angle = ast.literal_eval(self.desk.ask(facts)) or (0, 0, 0)
            told = [getattr(self, name).text_content() for name in ("points", "triangles", "smallest")]
            plural = "s" * (triangles != 1)
            if told == [f"{points:,} points", f"{triangles:,} triangle{plural}", f"smallest angle {angle:.1f}°"]:
                return
            self.desk.page.wait_for_timeout(50)
        raise AssertionError(f"the page reads {told}, Python has {points}, {triangles}, {angle}")


@contextmanager
def cleared(opened, i=0):
    """The playground in the i-th cell, with an empty page and nothing switched on."""
    opened.begin_anew(RESET)
    board = opened.widget(i, "domain-playground", Board)
    for pressed in board.root.locator(".fem-bar [aria-pressed=true]").all():
        pressed.click()
    board.press("Escape", "Escape", "Escape")
    board.reads("points", "0 points")
    yield board
    opened.nothing_wrong()
