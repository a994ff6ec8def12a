"""Verdict: what a check found, in one sentence and a picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem_mesh.check.drawing import Drawing

Picture = dict[str, Any]


class CheckFailed(AssertionError):  # noqa: N818 - a student reads it
    """Raised by a check that found something wrong; the message says what. A notebook shows no traceback of it."""

    def _render_traceback_(self) -> list[str]:
        return [f"CheckFailed: {self}"]


class Wrong(Exception):  # noqa: N818 - no error of ours
    """What is wrong, found by a judge: a sentence, the step (from 1) and what to draw (see ``drawing``)."""

    def __init__(self, message: str, picture: Picture | None = None, step: int | None = None) -> None:
        super().__init__(message)
        self.message, self.picture, self.step = message, picture, step


@dataclass(frozen=True)
class Verdict:
    """What a check found. Made of plain values: ``as_json`` gives them, ``Verdict(**values)`` takes them.

    check : the name of the check
    right : whether all cases are right
    message : one sentence, what went wrong first
    case, step : where: the name of the case, and the number of the yield, from 1, or None
    passed, total : the cases that are right before that one, and all
    picture : what to draw, or None

    >>> print(Verdict("lawson", True, "right on all 9 cases", passed=9, total=9))
    lawson: right on all 9 cases
    >>> print(Verdict("lawson", False, "you flipped edge 3-9, but it was Delaunay", "a square", 7, 2, 9))
    lawson, case "a square", step 7: you flipped edge 3-9, but it was Delaunay
    """

    check: str
    right: bool
    message: str
    case: str = ""
    step: int | None = None
    passed: int = 0
    total: int = 0
    picture: Picture | None = None

    @classmethod
    def of_all(cls, check: str, total: int) -> Verdict:
        """That all cases are right."""
        number = "its case" if total == 1 else f"all {total} cases"
        return cls(check, True, f"right on {number}", passed=total, total=total)

    def __str__(self) -> str:
        case = f', case "{self.case}"' if self.case and self.total != 1 else ""
        step = f", step {self.step}" if self.step is not None else ""
        return f"{self.check}{case}{step}: {self.message}"

    def as_json(self) -> dict[str, Any]:
        """All of it as values that JSON knows."""
        return asdict(self)

    def draw(self) -> Drawing | None:
        """The picture: theirs beside what was expected; a notebook shows it. None where there is nothing to draw."""
        from fem_mesh.check.drawing import Drawing

        return None if self.picture is None else Drawing(self.picture, str(self))

    def html(self) -> str:
        """Sentence and picture, for a page."""
        from fem_mesh.check.drawing import html_of

        return html_of(self)


@contextmanager
def at_step(step: int, picture: Picture | None = None) -> Iterator[None]:
    """What is found wrong inside is wrong in this step; ``picture`` is for what has none of its own."""
    try:
        yield
    except Wrong as wrong:
        wrong.step, wrong.picture = step, wrong.picture or picture
        raise
