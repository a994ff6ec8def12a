"""Names of boundaries and regions, and the numbers that most files have instead."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

LARGEST_REGION = 1000  # a number beyond is not taken as an index into the names: there would be too many


def number_names(names: Iterable[str], word: str, first: int) -> dict[str, int]:
    """A number for each distinct name but "": 7 for "boundary 7", and from ``first`` on for all others.

    >>> number_names(["inlet", "wall", "", "inlet", "boundary 3"], "boundary", 2)
    {'inlet': 2, 'wall': 4, 'boundary 3': 3}
    """
    distinct = [name for name in dict.fromkeys(names) if name]
    fixed = {name: number for name in distinct if (number := _number_in(name, word))}
    numbers, taken, following = dict.fromkeys(distinct, 0), set(fixed.values()), first
    for name in distinct:
        while following in taken:
            following += 1
        numbers[name] = fixed.get(name, following)
        taken.add(numbers[name])
    return numbers


def name_number(number: float, word: str, names: Mapping[int, str]) -> str:
    """The name of a number: the one it has in ``names``, or "boundary 7"; 0 has none.

    >>> name_number(2, "boundary", {2: "inlet"}), name_number(3, "boundary", {}), name_number(0, "boundary", {})
    ('inlet', 'boundary 3', '')
    """
    whole = int(number) if number == int(number) else None
    if whole == 0:
        return ""
    return (names.get(whole) if whole is not None else None) or f"{word} {number if whole is None else whole}"


def number_regions(numbers: np.ndarray, names: Mapping[int, str]) -> tuple[np.ndarray, tuple[str, ...]]:
    """``regions`` and ``region_names`` of a mesh whose triangles a file gives the ``numbers`` (m,), 0 for none.

    The numbers stay as they are, unless some are negative or large: then they become 1, 2, ... in their order.

    >>> number_regions(np.array([2, 0, 2]), {2: "steel"})[1]
    ('', '', 'steel')
    >>> number_regions(np.array([7001, 0, -1]), {7001: "steel"})
    (array([2, 0, 1], dtype=int32), ('', 'region -1', 'steel'))
    """
    found = sorted({*np.unique(numbers).tolist(), *names} - {0})
    if not found:
        return np.zeros(len(numbers), np.int32), ("",)
    if found[0] > 0 and found[-1] <= LARGEST_REGION:
        return numbers.astype(np.int32), tuple(names.get(k, "") if k else "" for k in range(found[-1] + 1))
    regions = np.searchsorted(found, numbers) + 1
    regions[numbers == 0] = 0
    return regions.astype(np.int32), ("", *(name_number(k, "region", names) for k in found))


def name_regions(names: Sequence[str], regions: np.ndarray) -> list[str]:
    """The name of each number of a region: "region 7" where triangles have the number 7, and it has no name.

    >>> name_regions(["", "steel"], np.array([0, 1, 3]))
    ['', 'steel', '', 'region 3']
    """
    used = np.unique(regions).tolist()
    named = [*names, *[""] * (max(used, default=0) + 1 - len(names))]
    for number in used:
        named[number] = named[number] or name_number(number, "region", {})
    return named


def number_sets(sets: Mapping[str, np.ndarray], m: int) -> tuple[np.ndarray, tuple[str, ...], str]:
    """``regions`` and ``region_names`` of ``m`` triangles in named ``sets`` of them, and a note on those in several.

    >>> number_sets({"steel": np.array([0, 1]), "air": np.array([1, 3])}, 4)[:2]
    (array([1, 1, 0, 2], dtype=int32), ('', 'steel', 'air'))
    """
    numbers, tags, several = number_names(sets, "region", 1), np.zeros(m, np.int64), 0
    for name in reversed(numbers):  # the first wins
        several += int((tags[sets[name]] != 0).sum())
        tags[sets[name]] = numbers[name]
    note = f"{several:,} triangles are in several sets, and in the region of the first" if several else ""
    return *number_regions(tags, {number: name for name, number in numbers.items()}), note


def _number_in(name: str, word: str) -> int:
    """7 in "boundary 7", else 0."""
    match = re.fullmatch(rf"{word} ([1-9][0-9]{{0,8}})", name)
    return int(match[1]) if match else 0
