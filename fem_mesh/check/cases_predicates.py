"""Cases for orient and in_circle."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_mesh.predicates import orient

Case = dict[str, Any]
NEARLY_ON_A_LINE = [  # found by search: an error bound of differences, |uv - wz| for |uv| + |wz|, calls rounded signs sure
    [(0.811050104132898, 0.5000885385292291), (0.5370148697599578, 0.39869550181124125),
     (0.6431153728232669, 0.4379526879446656), (0.20084574293745117, 0.2743129248869138)],
    [(0.8529817375421727, 0.5156032428906021), (0.15115606205300436, 0.2559277429596134),
     (0.8496749680795893, 0.5143797381894463), (0.5005708048115801, 0.3852111977802838)],
    [(0.11779172362964596, 0.24358293774296902), (0.383094073137043, 0.3417448070607059),
     (0.3001094720297449, 0.31104050465100563), (0.925549896270423, 0.5424534616200565)],
    [(0.4447256692416872, 0.3645484976194252), (0.9317691508266195, 0.5447545858058501),
     (0.8382266226777717, 0.5101438503907765), (0.30840688593916854, 0.31411054779749326)],
]  # fmt: skip


def of_orient(random: np.random.Generator) -> list[Case]:
    simple = [[(0, 0), (1, 0), (0, 1)], [(0, 0), (0, 1), (1, 0)], [(0, 0), (1, 1), (2, 2)], [(3, 1), (-1, 2), (0, -4)]]
    anywhere = random.random((12, 3, 2))
    start, along = random.integers(-9, 10, (8, 1, 2)), random.integers(1, 10, (8, 1, 2))
    line = start + random.permuted(np.tile([0, 1, 2, 3], (8, 1)), axis=1)[:, :3, None] * along
    twice = [[(1, 2), (1, 2), (3, 4)], [(1, 2), (3, 4), (1, 2)], [(1, 2), (3, 4), (3, 4)], [(1, 2), (1, 2), (1, 2)]]
    return [
        _calls("simple turns", simple),
        _calls("random points", anywhere),
        _calls("three points on a line", line),
        _calls("points that coincide", twice),
        _calls("a large triangle", anywhere[:4] * 2.0**60),
        _calls("a tiny triangle", anywhere[:6] * 2.0**-60),
        _calls("far from the origin", np.round(anywhere[:6] * 64) / 64 + 2.0**30),
        _calls("a hair beside a line", _beside_a_line(random)),
        _calls("decimals, which are not quite what they seem", _decimals(random)),
    ]


def _beside_a_line(random: np.random.Generator) -> list[Any]:
    """Points a few units in the last place beside the line from (12, 12) to (24, 24): a plain determinant errs on
    every third (Kettner, Mehlhorn, Pion, Schirra, Yap 2008)."""
    steps = [(1, 0), (0, 1), (1, 2), (3, 2), *random.integers(0, 60, (12, 2)).tolist()]
    return [[(0.5 + i * 2.0**-53, 0.5 + j * 2.0**-53), (12, 12), (24, 24)] for i, j in steps]


def _decimals(random: np.random.Generator) -> list[Any]:
    """In line as they are written, mostly beside it as floats: 0.1 is 0.1000000000000000055."""
    known = [[(0.1, 0.3), (0.2, 0.6), (0.3, 0.9)], [(0.1, 0.1), (0.7, 0.3), (1.0, 0.4)], [(0.2, 0.1), (0.5, 0.2), (1.1, 0.4)]]
    starts, along = random.integers(1, 10, (2, 9, 2)).tolist()
    rows = [[(x + k * dx, y + k * dy) for k in (0, 1, 3)] for (x, y), (dx, dy) in zip(starts, along, strict=True)]
    return known + [[(x / 10, y / 10) for x, y in row] for row in rows]


def of_in_circle(random: np.random.Generator) -> list[Case]:
    simple = [(0.5, 0.5), (2, 2), (0.9, 0.9), (-1, 0.5), (1, 1)]
    anywhere = np.array([_left(*four) for four in random.random((12, 4, 2)).tolist()])
    circle = np.array([(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3), (0, -5), (3, -4)])
    on = [_left(*circle[random.permutation(10)[:4]].tolist()) for _ in range(8)]
    up, down = 1 + 2.0**-52, 1 - 2.0**-53
    hairs: list[Any] = [[(1, 0), (0, 1), (-1, 0), (0, -by)] for by in (up, down, 1)]
    hairs += [[(4 * s, 3 * s), (-3 * s, 4 * s), (-4 * s, -3 * s), (5 * s * by, 0)] for s in (0.1, 1, 7) for by in (up, down)]
    hairs += [_left(*(np.array(four) + 2.0**20 + random.integers(-1, 2, (4, 2)) * 2.0**-32).tolist()) for four in on]
    return [
        _calls("a right triangle", [[(0, 0), (1, 0), (0, 1), d] for d in simple]),
        _calls("random points", anywhere),
        _calls("four points on a circle", [*on, [(0, 0), (4, 0), (4, 3), (0, 3)]]),
        _calls("a corner of the triangle itself", [[(0, 0), (3, 1), (1, 2), d] for d in ((0, 0), (3, 1), (1, 2))]),
        _calls("a large triangle", anywhere[:4] * 2.0**40),
        _calls("a tiny triangle", anywhere[:6] * 2.0**-30),
        _calls("a hair inside, a hair outside", hairs),
        _calls("rectangles, or but for a hair", [*_rectangles(np.random.default_rng(1)), *_rectangles(random)]),
        _calls("points nearly on a line", NEARLY_ON_A_LINE),
    ]


def _rectangles(random: np.random.Generator) -> list[Any]:
    """The fourth corner lies exactly on the circle of the others, or a unit in the last place beside it."""
    calls = []
    for scale in (2.0**-20, 1.0, 2.0**20):
        for left, low, right, high in (random.random((6, 4)) + np.array([0, 0, 1, 1])).tolist():
            for x in (left, float(np.nextafter(left, 1)), float(np.nextafter(left, 0))):
                calls.append(scale * np.array([(left, low), (right, low), (right, high), (x, high)]))
    return calls


def _left(a: Any, b: Any, c: Any, d: Any) -> list[Any]:
    return [a, b, c, d] if orient(a, b, c) > 0 else [a, c, b, d]


def _calls(name: str, calls: Any) -> Case:
    return {"name": name, "calls": [[[float(x), float(y)] for x, y in points] for points in calls]}
