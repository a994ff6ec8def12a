"""Which triangle holds a point: a tree of boxes over the triangles, for any mesh, convex or not.

Triangles are sorted along a Hilbert curve, and pairs of neighbours, pairs of pairs, ... share a box. A
query opens only the boxes that hold it: some log m of them, whatever the grading of the mesh.
"""

from __future__ import annotations

import numpy as np

from fem_mesh.kernel import call, kernel
from fem_mesh.mesh.order import curve_order
from fem_mesh.predicates import orient_sign


class Locator:
    """Answers queries for one mesh. Level 0 of the tree are its leaves, the last level its root."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self.points, self.triangles = points.copy(), triangles.copy()
        self.leaf = curve_order(points[triangles].mean(axis=1)) if len(triangles) else np.empty(0, np.int64)
        corners = points[triangles[self.leaf]]
        levels = [np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)]
        while len(levels[-1]) > 1:  # each level is half as long as the one below
            boxes = levels[-1]
            if len(boxes) % 2:
                boxes = np.concatenate([boxes, boxes[-1:]])
            low = np.minimum(boxes[::2, :2], boxes[1::2, :2])
            levels.append(np.concatenate([low, np.maximum(boxes[::2, 2:], boxes[1::2, 2:])], axis=1))
        self.boxes = np.concatenate(levels)
        self.start = np.cumsum([0] + [len(level) for level in levels])

    def find(self, queries: np.ndarray) -> np.ndarray:
        """The lowest triangle in or on which each query lies, -1 outside: int32 (k,)."""
        found = np.full(len(queries), -1, np.int32)
        if len(self.triangles):
            arrays = (self.points, self.triangles, self.leaf, self.boxes, self.start)
            size = len(queries)
            call(find_triangles, queries, *arrays, found, size=size)
        return found


@kernel
def find_triangles(queries, points, triangles, leaf, boxes, start, found):
    for q in range(len(queries)):
        x, y = queries[q, 0], queries[q, 1]
        level, i = len(start) - 2, 0
        while level < len(start) - 1:  # each turn goes to another box: down, right, or up
            k = start[level] + i
            inside = boxes[k, 0] <= x and x <= boxes[k, 2] and boxes[k, 1] <= y and y <= boxes[k, 3]
            if inside and level > 0:
                level, i = level - 1, 2 * i
                continue
            if inside:
                t = leaf[i]
                if (found[q] < 0 or t < found[q]) and holds(points, triangles, t, x, y):
                    found[q] = t
            while level < len(start) - 1 and (i % 2 == 1 or start[level] + i + 1 >= start[level + 1]):
                level, i = level + 1, i // 2
            i += 1


@kernel
def holds(points, triangles, t, x, y):
    """Whether (x, y) lies in or on triangle t."""
    for i in range(3):
        a, b = triangles[t, i], triangles[t, (i + 1) % 3]
        if orient_sign(points[a, 0], points[a, 1], points[b, 0], points[b, 1], x, y) < 0.0:
            return False
    return True
