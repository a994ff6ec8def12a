"""Seeds of holes and of regions: the triangles they lie in, and what they reach."""

from __future__ import annotations

import numpy as np

from fem_mesh.algorithms.carving import OUTSIDE, UNKNOWN
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.mesh.locator import Locator
from fem_mesh.mesh.quality import turns_of
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import REACHED


def ghosts(parts: Segmented) -> np.ndarray:
    """Which triangles are ghosts: bool (count,)."""
    return np.asarray((parts.work.origin[: 3 * parts.count].reshape(-1, 3) == 0).any(axis=1))


def locate_seeds(domain: Domain, parts: Segmented) -> list[int]:
    """The triangle of each hole seed, then of each region's. Raises MeshError for one on a segment or beyond the hull."""
    places = [*map(tuple, domain.holes.tolist()), *((region.x, region.y) for region in domain.regions)]
    if not places:
        return []
    work = parts.work
    real = np.flatnonzero(~ghosts(parts))
    triangles = work.origin[: 3 * parts.count].reshape(-1, 3)[real].astype(np.int64)
    found = Locator(work.xy, triangles).find(np.array(places))
    for i, (t, place) in enumerate(zip(found.tolist(), places, strict=True)):
        what = say_seed(domain, i)
        if t < 0:
            raise MeshError(f"{what} at {place} lies outside the domain: put it inside, or drop it")
        for k in range(3):
            h = 3 * int(real[t]) + k
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            corners = np.array([work.xy[a], work.xy[b], place])
            if parts.segment[h] and turns_of(corners, np.array([[0, 1, 2]]))[0] == 0:
                row = int(parts.piece_of[parts.segment[h]])
                raise MeshError(f"{what} at {place} lies on segment {say_rows(domain, [row])}: move it to one side")
    return [int(t) for t in real[found]]


def begin_at_seed(domain: Domain, parts: Segmented, side: np.ndarray, i: int, t: int, from_hull: int) -> None:
    """Let the flood in at hole seed ``i``, in triangle ``t``, unless another seed of the same hole did."""
    work = parts.work
    if side[t] == UNKNOWN:
        side[t] = OUTSIDE
        work.cavity[work.state[REACHED]] = t
        work.state[REACHED] += 1
    elif t in work.cavity[:from_hull]:
        place = tuple(domain.holes[i].tolist())
        raise MeshError(f"{say_seed(domain, i)} at {place} lies outside the domain: the flood from there has come by")


def color_regions(domain: Domain, parts: Segmented, side: np.ndarray, seeds: list[int]) -> None:
    """Number the triangles of each region, from its seed up to the segments around it: 1, 2, ..."""
    work, m = parts.work, parts.count
    parts.region = np.zeros(m, np.int32)
    twin, segment = work.twin[: 3 * m].reshape(-1, 3), parts.segment[: 3 * m].reshape(-1, 3)
    for i, t in enumerate(seeds):
        what = say_seed(domain, len(domain.holes) + i)
        place = (domain.regions[i].x, domain.regions[i].y)
        if side[t] == OUTSIDE:
            raise MeshError(f"{what} at {place} lies outside the domain or in a hole: put it inside, or drop it")
        if parts.region[t]:
            other = domain.regions[int(parts.region[t]) - 1].name
            raise MeshError(f"{what} at {place} lies in the same part as region {other!r}: a segment must part them")
        front = np.array([t])
        while len(front):  # each turn colours triangles that had no colour
            parts.region[front] = i + 1
            across = (twin[front] // 3)[segment[front] == 0]
            front = np.unique(across[(parts.region[across] == 0) & (side[across] != OUTSIDE)]).astype(np.int64)
    parts.region[ghosts(parts)] = 0


def say_seed(domain: Domain, i: int) -> str:
    j = len(domain.holes)
    return f"hole seed {i}" if i < j else f"region {domain.regions[i - j].name!r}"


def say_rows(domain: Domain, rows: list[int]) -> str:
    """The user's rows of segments, with their end points."""
    shown = []
    for row in rows[:5]:
        (ax, ay), (bx, by) = domain.points[domain.segments[row]].tolist()
        shown.append(f"{int(domain.source[row])} from ({ax:.6g}, {ay:.6g}) to ({bx:.6g}, {by:.6g})")
    return ", ".join(shown) + (f" and {len(rows) - 5} more" if len(rows) > 5 else "")
