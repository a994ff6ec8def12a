"""Lifetimes: rows of numbers, each with the step that brought it and the step that took it."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np

NEVER = np.iinfo(np.int32).max


class Lifetimes:
    """Rows of numbers, each under a key, each with the step that began and the step that ended it.

    >>> lives = Lifetimes("i", 2)
    >>> lives.begin("ab", (0, 1), 3)
    >>> lives.end("ab", 5)
    True
    >>> [len(lives.at(k)[1]) for k in range(2, 6)]
    [0, 1, 1, 0]
    """

    def __init__(self, typecode: str, width: int) -> None:
        self._rows, self._width = array(typecode), width
        self._born, self._died, self._keys = array("i"), array("i"), array("i")
        self.alive: dict[Any, int] = {}
        self.size = 0  # one more than the highest number among the keys (points only)

    def begin(self, key: Any, row: Any, k: int) -> None:
        """A row comes at step ``k``, under a key that is free."""
        self.alive[key] = len(self._born)
        self._rows.extend(row)
        self._born.append(k)
        self._died.append(NEVER)
        number = key if isinstance(key, int) else 0
        self._keys.append(number)
        self.size = max(self.size, number + 1)

    def end(self, key: Any, k: int) -> bool:
        """The row under a key goes at step ``k``; returns whether there was one."""
        row = self.alive.pop(key, None)
        if row is not None:
            self._died[row] = k
        return row is not None

    def current(self) -> dict[Any, tuple[Any, ...]]:
        """The rows alive after the last step, by key."""
        w = self._width
        return {key: tuple(self._rows[w * row : w * row + w]) for key, row in self.alive.items()}

    def table(self) -> np.ndarray:
        """Every row that ever came, in the order of coming."""
        return np.array(self._rows).reshape(-1, self._width)

    def lifetimes(self) -> tuple[np.ndarray, np.ndarray]:
        """For each row of the table the step that began it, and the step that ended it or NEVER."""
        return np.array(self._born), np.array(self._died)

    def at(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """The keys and rows alive after step k."""
        born, died = self.lifetimes()
        alive = (born <= k) & (k < died)
        return np.array(self._keys)[alive], self.table()[alive]

    def keys(self) -> np.ndarray:
        """The key of each row: a point's number."""
        return np.array(self._keys, dtype=np.int64)

    def final(self, size: int) -> np.ndarray:
        """The last row of each key."""
        result = np.full((size, self._width), np.nan)
        if size:
            result[np.array(self._keys)] = self.table()
        return result
