"""The verb: a Delaunay triangulation, as fast as it goes."""

from __future__ import annotations

from typing import Any

from fem_mesh.algorithms.bowyer_watson import insert_points, insertion_state
from fem_mesh.algorithms.lawson import begin_from, flip_edges, flip_state
from fem_mesh.kernel import run
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.order import insertion_order
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.workspace import FLIPPED, NEXT, Workspace


def delaunay(points: Any, triangles: Any = None) -> Mesh:
    """The Delaunay triangulation of ``points`` (n, 2): a Mesh whose every circle is empty, exactly.

    Runs ``bowyer_watson``; or ``lawson``, from the given ``triangles`` (m, 3), any triangulation of
    the points. Large inputs run compiled, small ones in plain Python, with the same result.

    Equal points are merged (``mesh.merged_into``). Fewer than 3 points, or all on one line: a mesh
    without triangles whose ``note`` says why. Raises MeshError for points that are no finite pairs of
    numbers, and for triangles that are no triangulation.

    >>> delaunay([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)])
    Mesh: 5 points, 4 triangles, smallest angle 45.0 degrees
    >>> delaunay([(0, 0), (1, 1), (2, 2)]).note
    'no triangles: all 3 points lie on one line'
    """
    if triangles is not None:
        work = begin_from(points, triangles)
        run(flip_edges, flip_state(work), len(work.points), done=lambda: work.state.item(FLIPPED))
        return work.to_mesh()
    points = as_points(points)
    work = Workspace.of_points(points, insertion_order(points))
    if not work.note:
        n = len(points)
        run(insert_points, insertion_state(work), n, total=n, done=lambda: work.state.item(NEXT) - 1)
    return work.to_mesh()
