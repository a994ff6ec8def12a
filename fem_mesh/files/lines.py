"""A text file as lines of numbers: each complaint about it names the file and the line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fem_mesh.errors import MeshError

SHOWN = 24  # characters of a word in a message


class Lines:
    """The lines of the text file ``path`` that hold more than a comment (from # on), read one by one.

    comments : what follows each #, without it
    """

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        if b"\0" in data:
            raise MeshError(f"{path} is no text file: it holds bytes that are 0")
        text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
        self.path = path
        self.comments: list[str] = []
        self._lines: list[tuple[int, str]] = []
        self._next = 0
        lines = text.split("\n")
        self._last = max(len(lines) - (lines[-1] == ""), 1)
        for number, line in enumerate(lines, 1):
            said, mark, comment = line.partition("#")
            if mark:
                self.comments.append(comment)
            if said.strip():
                self._lines.append((number, said))

    def error(self, number: int, complaint: str) -> MeshError:
        return MeshError(f"{self.path}, line {number}: {complaint}")

    def at_end(self) -> bool:
        return self._next == len(self._lines)

    def check_end(self, last: str) -> None:
        """There is nothing left. ``last`` says what came last, for the message."""
        if not self.at_end():
            number, said = self._lines[self._next]
            raise self.error(number, f"expected the end of the file after {last}, found {_shown(said.strip())}")

    def take(self, what: str, names: Sequence[str], least: int) -> tuple[int, list[float]]:
        """The next line: its number, and at least ``least`` values, one each for the ``names`` at most."""
        if self.at_end():
            raise self.error(self._last, f"the file ends where {what} should be: is it cut off?")
        number, said = self._lines[self._next]
        self._next += 1
        words = said.split()
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = [math.nan]
        if "_" in said or not all(map(math.isfinite, values)):
            raise self.error(number, self._complaint(words))
        if not least <= len(values) <= len(names):
            wanted = f"{least}" if least == len(names) else f"{least} to {len(names)}"
            numbers = f"number{'s' * (wanted != '1')}"
            raise self.error(number, f"expected {wanted} {numbers} for {what} ({', '.join(names)}), found {len(values)}")
        return number, values

    def take_count(self, of: str, names: Sequence[str] = (), least: int = 1) -> tuple[int, list[int]]:
        """The line that says how many ``of`` something follow, and other whole numbers: its number, and these."""
        number, values = self.take(f"the number of {of}", (f"number of {of}", *names), least)
        for value in values:
            if value != int(value):
                raise self.error(number, f"expected whole numbers, found {value!r}")
        if values[0] < 0:
            raise self.error(number, f"the number of {of} is {int(values[0])}, which is less than none")
        return number, [int(value) for value in values]

    def take_table(self, count: int, what: str, names: Sequence[str], least: int) -> tuple[np.ndarray, list[int]]:
        """``count`` lines as float64 (count, len(names)), nan where a line has only ``least`` values; their numbers."""
        ahead = self._lines[self._next : self._next + count]
        table = _table([said for _, said in ahead], len(names)) if len(ahead) == count else None
        if table is not None:
            self._next += count
            return table, [number for number, _ in ahead]
        numbers, rows = [], []  # something is missing, or wrong: line by line, to say where
        for k in range(count):
            number, values = self.take(f"{what} {k + 1} of {count}", names, least)
            numbers.append(number)
            rows.append(values + [math.nan] * (len(names) - len(values)))
        return np.array(rows, np.float64).reshape(count, len(names)), numbers

    def check_whole(self, values: np.ndarray, numbers: list[int], what: str) -> np.ndarray:
        """``values`` (count,) or (count, k) as int64. ``what`` says what they are, for the message."""
        wrong = (values != np.floor(values)) | (np.abs(values) >= 2**53)
        for place in np.argwhere(wrong)[:1]:
            raise self.error(numbers[place[0]], f"expected whole numbers for {what}, found {values[tuple(place)].item()!r}")
        return values.astype(np.int64)

    def check_numbered(self, values: np.ndarray, numbers: list[int], what: str) -> int:
        """Lines are numbered in order, from 0 or from 1: returns which."""
        given = self.check_whole(values, numbers, f"the number of a {what}").tolist()
        first = given[0] if given else 0
        if first not in (0, 1):
            raise self.error(numbers[0], f"the first {what} has the number {first}: they are numbered from 0 or from 1")
        for k, number in enumerate(given, first):
            if number != k:
                again = f", which line {numbers[number - first]} has already" if first <= number < k else ""
                raise self.error(numbers[k - first], f"expected {what} {k}, found number {number}{again}")
        return first

    def _complaint(self, words: list[str]) -> str:
        for word in words:
            try:
                wrong = "_" in word or not math.isfinite(float(word))
            except ValueError:
                wrong = True
            if wrong and "," in word:
                return f"found a comma in {_shown(word)}: numbers are written 0.5 and separated by spaces"
            if wrong:
                return f"expected a number, found {_shown(word)}"
        raise AssertionError("every word is a number")


def _table(lines: list[str], columns: int) -> np.ndarray | None:
    """Lines of finite numbers as float64 (len(lines), columns), or None if they are not that."""
    try:
        rows = [list(map(float, line.split())) for line in lines]
    except ValueError:
        return None
    if any(len(row) != columns for row in rows) or any("_" in line for line in lines):
        return None
    table = np.array(rows, np.float64).reshape(len(lines), columns)
    return table if np.isfinite(table).all() else None


def _shown(word: str) -> str:
    return repr(word if len(word) <= SHOWN else word[:SHOWN] + "...")
