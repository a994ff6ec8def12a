"""A transcript, read: what came of each case. Nothing in it is trusted; what it may not say raises Wrong."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from fem_mesh.check.reading import describe
from fem_mesh.check.run import GENERATORS, STEPS
from fem_mesh.check.verdict import Wrong


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


def read_run(check: str, case: dict[str, Any], record: Any) -> Run:
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
