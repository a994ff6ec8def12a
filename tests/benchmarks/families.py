"""The point sets that speed is measured on: each defined exactly, with its seed."""

import numpy as np


def uniform(n):
    return np.random.default_rng(1).random((n, 2))


def clustered(n):
    random = np.random.default_rng(2)
    return random.random((20, 2))[random.integers(0, 20, n)] + random.normal(0, 1e-3, (n, 2))


def grid(n):
    side = np.linspace(0, 1, round(n**0.5))
    return np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)


def integer_grid(n):
    return np.round(grid(n) * (round(n**0.5) - 1))


def tilted_grid(n):
    angle = np.radians(302.328)
    return grid(n) @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def ring(n):
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def ring_with_centre(n):
    return np.concatenate([ring(n - 1), [[0.0, 0.0]]])


def spiral(n):
    s = np.linspace(0, 1, n)
    return np.column_stack([s * np.cos(40 * s), s * np.sin(40 * s)])


def star_outline(n):
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return ring(n) * (1 + 0.5 * np.cos(50 * angle))[:, None]


FAMILIES = [uniform, clustered, grid, integer_grid, tilted_grid, ring, ring_with_centre, spiral, star_outline]
