"""The domains that meshing is measured on: each defined exactly, with its seed, as (points, segments, holes)."""

import numpy as np


def closed(first, n):
    """The rows of a closed outline of n points numbered from ``first``."""
    return np.column_stack([first + np.arange(n), first + (np.arange(n) + 1) % n])


def assemble(outlines, holes, loose=None):
    firsts = np.cumsum([0] + [len(outline) for outline in outlines])
    segments = np.vstack([closed(first, len(outline)) for first, outline in zip(firsts, outlines, strict=False)])
    points = np.vstack([*outlines, np.empty((0, 2)) if loose is None else loose])
    return points, segments, np.array(holes, float).reshape(-1, 2)


def box(left, bottom, right, top):
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)], float)


def plate():
    """A plate, 2 x 1, with a round hole of radius 0.2 made of 64 straight segments."""
    angle = 2 * np.pi * np.arange(64) / 64
    hole = np.column_stack([1 + 0.2 * np.cos(angle), 0.5 + 0.2 * np.sin(angle)])
    return assemble([box(0, 0, 2, 1), hole], [(1, 0.5)])


def airfoil():
    """NACA 2412 with a closed tail, 200 straight segments, in a box from (-3, -3) to (5, 3)."""
    half = np.pi * np.arange(101) / 100  # from tail to nose, closer together at both
    x = 0.5 * (1 + np.cos(half))
    thickness = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    camber, place = 0.02, 0.4
    ahead = x < place
    line = np.where(ahead, camber / place**2 * (2 * place * x - x**2), 0.0)
    line += np.where(ahead, 0.0, camber / (1 - place) ** 2 * (1 - 2 * place + 2 * place * x - x**2))
    slope = 2 * camber * (place - x) * np.where(ahead, 1 / place**2, 1 / (1 - place) ** 2)
    across = thickness / np.sqrt(1 + slope**2)
    upper = np.column_stack([x - slope * across, line + across])
    lower = np.column_stack([x + slope * across, line - across])
    foil = np.vstack([upper, lower[-2:0:-1]])
    return assemble([box(-3, -3, 5, 3), foil], [(0.3, 0.02)])


def lake(n=400, seed=7):
    """A smooth random outline of n segments that its middle sees all of."""
    random, angle = np.random.default_rng(seed), 2 * np.pi * np.arange(n) / n
    radius = np.ones(n)
    for k in range(2, 13):
        radius += 0.5 / k * random.normal() * np.cos(k * angle + random.uniform(0, 2 * np.pi))
    return assemble([np.maximum(radius, 0.15)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])], [])


def scattered():
    """A square with 1,000 random points in it."""
    return assemble([box(0, 0, 1, 1)], [], np.random.default_rng(11).random((1000, 2)))


def l_shape():
    """Six corners: for sizes, where the outline costs nothing."""
    return assemble([np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], float)], [])


def zigzag(n=10_000, seed=13):
    """A closed boundary of n segments of very different lengths, which its middle sees all of: for the CDT."""
    random = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(n) + 0.9 * random.random(n)) / n
    return assemble([random.uniform(0.5, 1, n)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])], [])


DOMAINS = [plate, airfoil, lake, scattered]
