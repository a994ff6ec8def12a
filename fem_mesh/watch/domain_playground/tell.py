"""What the domain playground tells of a mesh: encroached segments, angles, what was achieved, arrays for the browser."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np

from fem_mesh.mesh.mesh import Mesh
from fem_mesh.predicates import in_diametral_circle

BINS = 36  # of the histogram of angles, each of 5 degrees
EMPTY = np.empty((0, 2), np.int32)


def encroached_segments(mesh: Mesh, lens: float | None = None) -> np.ndarray:
    """The segments that are encroached upon: the apex of a triangle at it lies inside its diametral circle, exactly.

    Of all vertices that see the segment, one of these sees it under the widest angle. With ``lens``, the bound on
    angles in degrees, only the lens counts in which that angle is 180 - 2 ``lens`` or more. int32 (k, 2).

    >>> import fem_mesh as fm
    >>> flat = fm.constrained_delaunay(fm.Domain.from_loops([(0, 0), (4, 0), (4, 1), (2, 1), (0, 1)]))
    >>> encroached_segments(flat).tolist(), encroached_segments(flat, lens=20).tolist()
    ([[0, 1]], [])
    """
    m = len(mesh.triangles)
    if not m or not len(mesh.segments):
        return EMPTY
    sides = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)]).astype(np.int64)
    apexes = np.concatenate([mesh.triangles[:, (i + 2) % 3] for i in range(3)])
    n = len(mesh.points)
    keys, wanted = (np.sort(pairs, axis=1) @ [n, 1] for pairs in (sides, mesh.segments.astype(np.int64)))
    row = np.argsort(wanted)
    at = np.minimum(np.searchsorted(wanted[row], keys), len(wanted) - 1)
    here = wanted[row[at]] == keys
    segment, apex = row[at[here]], apexes[here]
    a, b, p = (mesh.points[v] for v in (*mesh.segments[segment].T, apex))
    u, v = a - p, b - p
    dot, squares = (u * v).sum(axis=1), (u * u).sum(axis=1) * (v * v).sum(axis=1)
    cosine = math.cos(math.radians(2 * lens)) if lens is not None and lens < 45 else 0.0
    likely = np.flatnonzero((dot < 1e-9 * np.sqrt(squares)) & (dot * dot >= cosine * cosine * squares))
    inside = [k for k in likely.tolist() if in_diametral_circle(a[k], b[k], p[k])]
    return np.asarray(mesh.segments[np.unique(segment[inside])])


def say_state(mesh: Mesh | None) -> str:
    """What the refinement achieved, in a sentence."""
    if mesh is None:
        return ""
    if mesh.note and not len(mesh.triangles):
        return mesh.note
    refinement = mesh.refinement
    if refinement is None:
        return "no bounds: constrained Delaunay, no points added"
    added = f"{refinement.added:,} point{'s' * (refinement.added != 1)} added"
    left = [f"{count:,} triangle{'s' * (count != 1)} left ({why})" for why, count in Counter(refinement.why).items()]
    return ", ".join([f"{'complete' if refinement.complete else 'incomplete'}: {added}", *left])


def arrays_of(mesh: Mesh, encroached: np.ndarray) -> tuple[list[bytes], dict[str, Any]]:
    """A mesh as buffers: x, y, triangles, segments, encroached segments, the smallest angle of each; and a histogram."""
    angles = mesh.angles()
    smallest = angles.min(axis=1, initial=180.0)
    counts, _ = np.histogram(angles, BINS, (0.0, 180.0))
    arrays = (mesh.points.T.astype("<f8"), *(rows.astype("<i4") for rows in (mesh.triangles, mesh.segments, encroached)))
    return [array.tobytes() for array in (*arrays, smallest.astype("<f4"))], {"histogram": counts.tolist()}
