"""The half of a check that judges a transcript. It trusts nothing in it: whatever JSON comes, a verdict goes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from fem_mesh.check.judges.bowyer_watson import judge_bowyer_watson
from fem_mesh.check.judges.lawson import judge_lawson
from fem_mesh.check.judges.meshes import judge_mesh
from fem_mesh.check.judges.pieces import judge_cavity, judge_flip
from fem_mesh.check.judges.predicates import judge_in_circle, judge_orient
from fem_mesh.check.judges.ruppert import judge_encroached, judge_ruppert
from fem_mesh.check.judges.segments import judge_carve, judge_segments
from fem_mesh.check.reading import describe
from fem_mesh.check.run import GENERATORS, STEPS
from fem_mesh.check.verdict import Verdict, Wrong
from fem_mesh.errors import MeshError
from fem_mesh.watch.svg import NO_XML

Case = dict[str, Any]
Judge = Callable[[Case, "Run"], None]

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


@dataclass(frozen=True)
class Run:
    """What came of one case: what was yielded, what was returned, and how it ended."""

    check: str
    kind: str
    yields: list[Any]
    returned: Any
    error: dict[str, Any] | None
    stopped: str | None
    points: Any = None

    def numbered(self, message: str) -> str:
        """What an exception says of points, by their numbers where they are the case's."""
        for v, (x, y) in enumerate(self.points or ()):
            message = message.replace(f"({x}, {y})", f"point {v}")
        return re.sub(r"point (\d+), point (\d+), point (\d+)", r"points \1, \2, \3", message)

    def finish(self, calls: int | None = None) -> None:
        """Raise Wrong if it did not end by itself, or did not answer so many calls; judged after all that was yielded."""
        if self.error is not None:
            step = len(self.yields) + 1 if self.kind == "generator" else None
            raise Wrong(self.numbered(say_error(self.check, self.error)), step=step)
        if self.stopped is not None:
            raise Wrong(f"it has not ended after {len(self.yields)} steps, more than it can need: when does its loop end?")
        if calls is not None and len(self.yields) != calls:
            raise Wrong(f"{len(self.yields)} answers came of {calls} calls")

    def steps(self) -> Iterable[tuple[int, Any]]:
        """What was yielded, numbered from 1. Raises Wrong if the work is no generator."""
        if self.check in GENERATORS and self.kind != "generator" and self.error is None:
            raise Wrong(
                f"{self.check} returned {describe(self.returned)}, but it is to be a generator: "
                "`yield` the current state after each change"
            )
        return enumerate(self.yields, start=1)


def read_run(check: str, case: Case, record: Any) -> Run:
    """A transcript's record of one case, whatever it is; of yields no more than the case allows."""
    if not isinstance(record, dict):
        raise Wrong("nothing came of this case")
    yields, error, stopped = record.get("yields"), record.get("error"), record.get("stopped")
    if not isinstance(yields, list) or not isinstance(error, dict | None) or not isinstance(stopped, str | None):
        raise Wrong("what came of this case cannot be read")
    most = len(case["calls"]) if "calls" in case else case.get("steps", STEPS)
    if len(yields) > most:
        yields, stopped = yields[:most], "steps"
    return Run(check, str(record.get("kind")), yields, record.get("returned"), error, stopped, case.get("points"))


def say_error(check: str, error: dict[str, Any]) -> str:
    """What was raised, and at which of their lines."""
    kind, message = str(error.get("type"))[:80], str(error.get("message"))[:300]
    line, source = error.get("line"), str(error.get("source"))[:200]
    at = "it" if not isinstance(line, int) else f"line {line}, `{source}`," if source else f"line {line}"
    if kind == "NotImplementedError":
        return f"{check} is not written yet: {at} raises NotImplementedError"
    if kind == "OutOfTime":
        return f"no end after {message}: {'the loop in ' * (at != 'it')}{at} was still running"
    return f"{at} raised {kind}{': ' if message else ''}{message}"
