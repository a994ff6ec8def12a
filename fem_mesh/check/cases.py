"""The cases of a check, from easy to nasty: plain JSON, made where the student's code does not run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fem_mesh.check.cases_domains import of_carve, of_encroached, of_ruppert, of_segments
from fem_mesh.check.cases_meshes import of_bowyer_watson, of_lawson
from fem_mesh.check.cases_pieces import of_cavity, of_flip
from fem_mesh.check.cases_predicates import of_in_circle, of_orient
from fem_mesh.check.disguise import disguised
from fem_mesh.errors import MeshError

Case = dict[str, Any]
MAKERS: dict[str, Callable[[np.random.Generator], list[Case]]] = {
    "orient": of_orient,
    "in_circle": of_in_circle,
    "flip": of_flip,
    "lawson": of_lawson,
    "cavity": of_cavity,
    "bowyer_watson": of_bowyer_watson,
    "segments": of_segments,
    "carve": of_carve,
    "encroached": of_encroached,
    "ruppert": of_ruppert,
}


def cases_of(check: str, seed: int = 0) -> list[Case]:
    """The cases of a check; another ``seed`` gives other random ones, and the same nasty ones in disguise.

    A case is a dict with a ``name`` and what the student's work is called with: ``calls``, each a list of points, or
    ``points``, ``triangles``, ``segments``, ``min_angle``. Raises MeshError for a check that does not exist.

    >>> cases_of("orient")[0]["calls"][0]
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    """
    if check not in MAKERS:
        raise MeshError(f"there are no cases for a check {check!r}: there are {', '.join(MAKERS)}")
    random = np.random.default_rng(seed)
    cases = MAKERS[check](random)
    return [disguised(check, case, random) for case in cases] if seed else cases
