"""What fem_mesh raises when it is given something it cannot mesh."""

from __future__ import annotations


class MeshError(ValueError):
    """Input or a mesh that is wrong: the message says what, where (indices, coordinates) and what to do.

    ``where`` is the place (x, y) of which it speaks, where there is one: of two outlines that cross, say.
    """

    def __init__(self, message: str = "", where: tuple[float, float] | None = None) -> None:
        super().__init__(message)
        self.where = where
