"""The playground's page, with five points on it: the corners of the unit square, and one near the middle."""

import ast
from contextlib import contextmanager

from .shared import Plane, Widget

SETUP = """
import fem_mesh as fm
playground = fm.Playground()
playground
"""
BEGINNING = [[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0.625]]
RESET = f"""
playground.circles = playground.voronoi = playground.ties = False
playground.numbers, playground.animated = None, False
playground.begin({BEGINNING})
playground._done.clear()
playground._undone.clear()
playground._send_all()
"""
PIXEL = 1.12 / 540  # at least, in the plane: the height of the view box in that of the canvas


class Square(Widget):
    """A playground that shows the unit square."""

    @property
    def plane(self):
        return Plane(self.desk.page, self.canvas, (-0.06, 1.06, -0.06, 1.06))

    def points_in_python(self):
        return ast.literal_eval(self.desk.ask("playground.points.tolist()"))

    def is_delaunay(self):
        """In Python: the mesh is one, and its trace leads to it."""
        ends = "len(playground.trace.frame(-1)[1]) == len(playground.mesh.triangles)"
        self.desk.comes_true(f"playground.mesh.is_delaunay() and {ends}")


@contextmanager
def five_points(opened):
    opened.begin_anew(RESET)
    playground = opened.widget(0, "playground", Square)
    playground.press("Escape", "0")
    playground.reads("points", "5 points")
    yield playground
    opened.nothing_wrong()
