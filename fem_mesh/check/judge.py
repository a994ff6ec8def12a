"""The half of a check that judges a transcript. It trusts nothing in it: whatever JSON comes, a verdict goes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fem_mesh.check.judges.bowyer_watson import judge_bowyer_watson
from fem_mesh.check.judges.lawson import judge_lawson
from fem_mesh.check.judges.meshes import judge_mesh
from fem_mesh.check.judges.pieces import judge_cavity, judge_flip
from fem_mesh.check.judges.predicates import judge_in_circle, judge_orient
from fem_mesh.check.judges.ruppert import judge_encroached, judge_ruppert
from fem_mesh.check.judges.segments import judge_carve, judge_segments
from fem_mesh.check.reading import describe
from fem_mesh.check.transcript import Run, read_run
from fem_mesh.check.verdict import Verdict, Wrong
from fem_mesh.errors import MeshError
from fem_mesh.watch.svg import NO_XML

Case = dict[str, Any]
Judge = Callable[[Case, Run], None]

JUDGES: dict[str, Judge] = {
    "orient": judge_orient,
    "in_circle": judge_in_circle,
    "flip": judge_flip,
    "lawson": judge_lawson,
    "cavity": judge_cavity,
    "bowyer_watson": judge_bowyer_watson,
    "segments": judge_segments,
    "carve": judge_carve,
    "encroached": judge_encroached,
    "ruppert": judge_ruppert,
    "mesh": judge_mesh,
}


def judge(check: str, transcript: Any, cases: Sequence[Case]) -> Verdict:
    """What ``transcript``, any JSON, is worth on the ``cases``: the first thing that is wrong, or that all is right.

    Raises MeshError for a check that does not exist; never for what stands in the transcript.

    >>> from fem_mesh.check import cases_of, run
    >>> cases = cases_of("orient")
    >>> print(judge("orient", run("orient", lambda a, b, c: 1, cases), cases))
    orient, case "simple turns": orient((0, 0), (0, 1), (1, 0)) must be negative, since c lies to the right; \
you returned 1
    """
    if check not in JUDGES:
        raise MeshError(f"there is no check {check!r}: there are {', '.join(JUDGES)}")
    try:
        return find_first(check, transcript, cases)
    except Exception as error:  # what a forger writes is not foreseen in every detail
        return Verdict(check, False, f"what came of the run makes no sense ({type(error).__name__})", total=len(cases))


def find_first(check: str, transcript: Any, cases: Sequence[Case]) -> Verdict:
    """As ``judge``, without its net."""
    if isinstance(transcript, dict) and isinstance(transcript.get("refused"), str):
        found = NO_XML.sub("", describe({"type": transcript["refused"]}))
        message = f"give the function itself, check.{check}({check}) without a call, not {found}"
        return Verdict(check, False, message, total=len(cases))
    runs = transcript.get("runs") if isinstance(transcript, dict) else None
    for k, case in enumerate(cases):
        try:
            JUDGES[check](case, read_run(check, case, runs[k] if isinstance(runs, list) and k < len(runs) else None))
        except Wrong as wrong:
            message = NO_XML.sub("", wrong.message)  # so that it can stand on any page
            return Verdict(check, False, message, case["name"], wrong.step, k, len(cases), wrong.picture)
    return Verdict.of_all(check, len(cases))
