"""Checks of what students write: each says in one sentence what went wrong first, and draws it.

>>> from fem_mesh import check, textbook
>>> check.lawson(textbook.lawson)
Traceback (most recent call last):
fem_mesh.check.verdict.CheckFailed: lawson, case "a kite with the wrong diagonal", step 2: nothing has changed since \
the step before: yield after each flip, and only then

A check has two halves: ``run`` calls the student's work on the cases that ``cases_of`` makes, and writes down what
came, as plain JSON; ``judge`` looks at that, and needs nothing else. No answer is stored anywhere: the geometry is
tested again, exactly. Points come to the student's work as pairs of floats, in a list; triangles as triples of point
numbers. Triangles may be given in any order and orientation, as lists, tuples, sets or arrays, or in a
``fem_mesh.Step``. What a generator returns at its end plays no part.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from fem_mesh.check.cases import cases_of
from fem_mesh.check.judge import judge
from fem_mesh.check.judges.meshes import mesh_case
from fem_mesh.check.run import given, run
from fem_mesh.check.verdict import CheckFailed, Verdict

Work = Callable[..., Any]

__all__ = [
    "CheckFailed", "Verdict", "bowyer_watson", "carve", "cases_of", "cavity", "encroached", "flip", "in_circle", "judge",
    "lawson", "mesh", "mesh_case", "orient", "run", "ruppert", "segments",
]  # fmt: skip


def orient(f: Work) -> None:
    """Check ``f(a, b, c)``: a number, positive if c lies to the left of the line from a to b, negative to the right, 0 on it.

    Every sign must be exact. Prints a line if all is right; else shows a picture, and raises CheckFailed with one
    sentence on what went wrong first. So do all checks.

    >>> import fem_mesh as fm
    >>> orient(fm.orient)
    orient: right on all 9 cases
    """
    conclude("orient", f)


def in_circle(f: Work) -> None:
    """Check ``f(a, b, c, d)``: whether d lies strictly inside the circle of the counter-clockwise triangle abc, exactly.

    >>> import fem_mesh as fm
    >>> in_circle(fm.in_circle)
    in_circle: right on all 9 cases
    """
    conclude("in_circle", f)


def flip(f: Work) -> None:
    """Check ``f(points, triangles, edge)``: all triangles with the other diagonal in place of the edge, or None.

    None where it cannot be: on the hull, and where the quadrilateral is not strictly convex.

    >>> flip(lambda points, triangles, edge: None)
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: flip, case "a kite": edge 0-2 can be flipped, for its quadrilateral 0, 1, 2, 3 \
is convex, but you returned None
    """
    conclude("flip", f)


def lawson(g: Work) -> None:
    """Check ``g(points, triangles)``: a generator that yields all triangles after each flip, until they are Delaunay.

    Each flip must be of an edge whose circle holds the vertex across; in which order does not matter. Where four points
    lie on one circle, the edge stays. Where there is nothing to flip, there is nothing to yield.

    >>> lawson(lambda points, triangles: iter([]))
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: lawson, case "a kite with the wrong diagonal": it ended, but edge 0-2 should still be \
flipped: vertex 3 lies inside the circle of 0, 2, 1
    """
    conclude("lawson", g)


def cavity(f: Work) -> None:
    """Check ``f(points, triangles, p)``: those of the counter-clockwise triangles whose circles hold p strictly inside.

    >>> import fem_mesh as fm
    >>> cavity(lambda points, triangles, p: [t for t in triangles if fm.in_circle(*(points[v] for v in t), p)])
    cavity: right on all 9 cases
    """
    conclude("cavity", f)


def bowyer_watson(g: Work) -> None:
    """Check ``g(points)``: a generator that yields after each point, in the order given, the Delaunay triangles so far.

    Until three points span a triangle it may yield nothing, or no triangles. What belongs to a super-triangle must not be
    in what is yielded.

    >>> bowyer_watson(lambda points: iter([[(0, 1, 2)]]))
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: bowyer_watson, case "a kite": it ended with 3 of 4 points: yield the triangles \
after each point
    """
    conclude("bowyer_watson", g)


def segments(g: Work) -> None:
    """Check ``g(points, triangles, segments)``: a generator that changes Delaunay triangles until the segments are edges.

    It may yield all triangles after each flip or after each segment. In the end every edge that is no segment must be
    Delaunay as far as its two triangles see.

    >>> segments(lambda points, triangles, segments: iter([]))
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: segments, case "a segment across one edge": it ended, but segment 0-1 is no edge: \
edge 2-3 crosses it
    """
    conclude("segments", g)


def carve(f: Work) -> None:
    """Check ``f(points, triangles, segments)``: returns those of the triangles that lie inside an odd number of loops.

    Segments that are on no loop bound nothing; without any loop, all triangles stay.

    >>> carve(lambda points, triangles, segments: triangles)
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: carve, case "an L-shape": triangle (2, 4, 3) lies outside or in a hole, but you kept it
    """
    conclude("carve", f)


def encroached(f: Work) -> None:
    """Check ``f(points, segments)``: returns the segments, as pairs, with a point strictly inside their diametral circles.

    >>> encroached(lambda points, segments: [])
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: encroached, case "a point near a side": point 4 lies inside the circle over segment \
0-1, but you left it out
    """
    conclude("encroached", f)


def ruppert(g: Work) -> None:
    """Check ``g(points, segments, min_angle)``: a generator of states ``(points, triangles)``, refined as Ruppert's (1995).

    The first state may be the constrained Delaunay triangulation of the points given; each further one has one point
    more, the last in the list: the midpoint of a segment that is encroached upon, or the centre of the circle of a
    triangle with an angle below ``min_angle`` degrees, if it lies in no segment's circle. Encroached segments go first.
    The triangles are those of the domain, or of the whole hull; in the end none in the domain has a smaller angle.

    >>> ruppert(lambda points, segments, min_angle: iter([]))
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: ruppert, case "a point near a side": it ended, but segment 0-1 is encroached upon \
by vertex 4
    """
    conclude("ruppert", g)


def mesh(points: Any, triangles: Any, delaunay: bool = True, min_angle: float | None = None, domain: Any = None) -> None:
    """Check a mesh: a valid triangulation, in any order and orientation.

    delaunay : every circle must be empty, and the convex hull covered; with a domain, constrained Delaunay
    min_angle : in degrees, that no angle may be below
    domain : a ``fem_mesh.Domain``, or a pair (points, segments), that it must cover, every segment a chain of edges

    >>> mesh([(0, 0), (1, 0), (0, 1)], [(0, 1, 2)], min_angle=30)
    mesh: right on its case
    >>> mesh([(0, 0), (1, 0), (0, 1)], [(0, 1, 2)], min_angle=50)
    Traceback (most recent call last):
    fem_mesh.check.verdict.CheckFailed: mesh: the smallest angle must be at least 50 degrees, but that of \
triangle (0, 1, 2) is 45.00
    """
    tell(judge("mesh", given(points, triangles), [mesh_case(delaunay, min_angle, domain)]))


def conclude(check: str, work: Any) -> None:
    """Run, judge and tell, case by case: what is wrong in the first need not wait for the last."""
    cases = cases_of(check)
    for passed, case in enumerate(cases):
        verdict = judge(check, run(check, work, [case]), [case])
        if not verdict.right:
            tell(replace(verdict, passed=passed, total=len(cases)))
    tell(Verdict.of_all(check, len(cases)))


def tell(verdict: Verdict) -> None:
    """Print the verdict if all is right; else show its picture, in a notebook, and raise CheckFailed."""
    if verdict.right:
        print(verdict)
        return
    drawing = verdict.draw()
    if drawing is not None and "IPython" in sys.modules:
        from IPython import get_ipython
        from IPython.display import display

        if get_ipython() is not None:
            display(drawing)
    raise CheckFailed(str(verdict))
