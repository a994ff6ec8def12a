"""The run that most of these tests play: Lawson's flips of nine points."""

import fem_mesh as fm

POINTS = fm.random_points(9, seed=1)
TRACE = fm.record(fm.lawson(POINTS, fm.any_triangulation(POINTS)))
LAST = len(TRACE) - 1
KINDS = [step.kind for step in TRACE]
CELLS = (
    """import fem_mesh as fm
points = fm.random_points(9, seed=1)
trace = fm.record(fm.lawson(points, fm.any_triangulation(points)))""",
    "trace",
    "player = fm.play(trace)\nplayer",
    "playground = fm.Playground(points)\nplayground",
)
TABLE = [f"{k}\t{step.kind}\t{step.caption}" for k, step in enumerate(TRACE)]
FIRST = f"step 0 of {LAST}, {KINDS[0]}: {TRACE[0].caption}"


def where(k):
    return f"step {k} of {LAST}, {KINDS[k]}"


def same_kind(k, way):
    """The next step of the same kind as step k, or k itself where there is none."""
    return next((j for j in range(k + way, LAST + 1 if way > 0 else -1, way) if KINDS[j] == KINDS[k]), k)
