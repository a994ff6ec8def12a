"""One generator, two drivers: same order, same arrays, to the last index."""

import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh import kernel
from fem_mesh.algorithms.bowyer_watson import INSERTED, insert_points, insertion_state
from fem_mesh.algorithms.lawson import begin_from, flip_edges, flip_state
from fem_mesh.mesh.order import fill_keys, insertion_order
from fem_mesh.mesh.workspace import COUNT, Workspace


def some_points(seed):
    """Points of many kinds: uniform, lattices full of ties, clusters, duplicates, nearly collinear."""
    random = np.random.default_rng(seed)
    n = int(random.integers(3, 60))
    points = random.random((n, 2))
    kind = seed % 5
    if kind == 1:
        points = np.floor(points * 6)
    elif kind == 2:
        points = np.floor(points * 8) / 15 + 1e6
    elif kind == 3:
        points = np.concatenate([points, points[::2]])
    elif kind == 4:
        points[:, 1] = points[:, 0] + np.round(points[:, 1]) * 2.0**-50
    return points


def drain_plain(generator, state):
    for _ in kernel.watch(generator, state):
        pass


def drain_compiled(generator, state, budget=kernel.EVENTS_A_CALL):
    drain = kernel.compile_driver(generator, state)
    while not drain(tuple(state), budget)[0]:
        pass


def inserted(points, drain):
    work = Workspace.of_points(points, insertion_order(points))
    if not work.note:
        drain(insert_points, insertion_state(work))
    used = 3 * work.state[COUNT]
    return work.origin[:used], work.twin[:used], work.merged, work.state


@pytest.mark.parametrize("seed", range(200))
def test_both_drivers_of_bowyer_watson_give_identical_arrays(seed):
    points = some_points(seed)
    for plain, compiled in zip(inserted(points, drain_plain), inserted(points, drain_compiled), strict=True):
        np.testing.assert_array_equal(plain, compiled)


def flipped(points, start, drain):
    work = begin_from(points, start)
    drain(flip_edges, flip_state(work))
    used = 3 * work.state[COUNT]
    return work.origin[:used], work.twin[:used], work.state


@pytest.mark.parametrize("seed", [seed for seed in range(120) if seed % 5 != 4])
def test_both_drivers_of_lawson_give_identical_arrays(seed):
    points = some_points(seed)
    start = fm.any_triangulation(points)
    for plain, compiled in zip(flipped(points, start, drain_plain), flipped(points, start, drain_compiled), strict=True):
        np.testing.assert_array_equal(plain, compiled)


@pytest.mark.parametrize("budget", [1, 2, 7])
def test_a_generator_dropped_after_any_settled_event_goes_on_where_it_stopped(budget):
    points = some_points(1)
    whole = inserted(points, drain_compiled)
    pieces = inserted(points, lambda generator, state: drain_compiled(generator, state, budget))
    for a, b in zip(whole, pieces, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_watched_generator_can_be_dropped_too():
    points = fm.random_points(50, seed=4)

    def drain_in_pieces(generator, state):
        event = 1
        while event:
            event = 0
            for event, _ in kernel.watch(generator, state):
                if event == INSERTED:
                    break

    for a, b in zip(inserted(points, drain_plain), inserted(points, drain_in_pieces), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_insertion_order_is_the_same_compiled():
    points = np.random.default_rng(0).random((500, 2))
    plain, compiled = np.empty(500, np.int64), np.empty(500, np.int64)
    arguments = (points, 0.0, 0.0, 1.0, 3)
    fill_keys(*(memoryview(a) if isinstance(a, np.ndarray) else a for a in arguments), memoryview(plain))
    kernel.compile_call(fill_keys, (*arguments, compiled))((*arguments, compiled))
    np.testing.assert_array_equal(plain, compiled)


def test_watched_steps_and_the_verb_end_in_the_same_mesh():
    points = fm.random_points(300, seed=9)
    trace = fm.record(fm.bowyer_watson(points, order="brio"))
    mesh = fm.delaunay(points)
    np.testing.assert_array_equal(trace.mesh.triangles, mesh.triangles)
    np.testing.assert_array_equal(trace.mesh.neighbors, mesh.neighbors)


# ---- in processes of their own -----------------------------------------------------------------------


def run(code, tmp_path, **environment):
    """Run a script in a fresh process; returns what it printed."""
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(code))
    done = subprocess.run(
        [sys.executable, "-W", "error", script], capture_output=True, text=True, timeout=900, env=os.environ | environment
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


TRIANGULATE = """
    import hashlib, numpy as np, fem_mesh as fm
    points = np.random.default_rng(3).random((4000, 2))
    mesh = fm.delaunay(points)
    print(hashlib.sha256(mesh.triangles.tobytes()).hexdigest())
"""


def test_without_numba_everything_still_runs_and_gives_the_same_mesh(tmp_path):
    blocked = "import sys; sys.modules['numba'] = None\n" + textwrap.dedent(TRIANGULATE)
    assert run(blocked, tmp_path) == run(TRIANGULATE, tmp_path)


@pytest.mark.exhaustive
def test_no_array_is_read_out_of_bounds(tmp_path):
    checked = run(TRIANGULATE, tmp_path, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert checked == run(TRIANGULATE, tmp_path)


REFINE = """
    import numpy as np, fem_mesh as fm
    from fem_mesh import kernel
    kernel.SMALL = -1
    for domain in (fm.plate_with_hole(), fm.airfoil(), fm.cracked_square()):
        for options in ({"min_angle": 33}, {"min_angle": 28, "size": lambda x, y: 0.1 + 0.05 * abs(x)}):
            mesh = fm.refine(domain, **options)
            print(len(mesh.triangles), fm.refine(mesh, max_area=0.01, where=np.arange(len(mesh.triangles)) % 3 == 0))
"""


@pytest.mark.exhaustive
def test_no_array_is_read_out_of_bounds_by_refinement(tmp_path):
    checked = run(REFINE, tmp_path, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert checked == run(REFINE, tmp_path)


EDITED = """
    import sys, numpy as np
    sys.path.insert(0, {folder!r})
    from fem_mesh import kernel
    import rule
    print(kernel.compile_call(rule.double, (np.ones(1),))((np.ones(1),)))
"""


@pytest.mark.parametrize("place", ["rule", "factors", "limits"])
def test_an_edited_kernel_never_meets_a_stale_compiled_driver(place, tmp_path):
    """What is edited stands in the kernel's own module, in that of a kernel it calls, or is a constant from elsewhere."""
    printed = []
    for value in (2.0, 3.0):
        values = {"rule": 1.0, "factors": 1.0, "limits": 1.0, place: value}
        kernels = "from fem_mesh.kernel import kernel\nfrom limits import MOST\n"
        factor = f"@kernel\ndef factor():\n    return {values['factors']}\n"
        double = f"from factors import factor\n@kernel\ndef double(a):\n    return a[0] * factor() * MOST * {values['rule']}\n"
        for name, code in {
            "limits": f"MOST = {values['limits']}",
            "factors": kernels + factor,
            "rule": kernels + double,
        }.items():
            (tmp_path / f"{name}.py").write_text(code)
        printed.append(run(EDITED.format(folder=str(tmp_path)), tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")))
    assert printed == ["2.0", "3.0"]


ATTRIBUTE = "import factors\n@kernel\ndef double(a):\n    return a[0] * factors.factor()\n"
ENCLOSED = """
def make():
    from factors import factor
    @kernel
    def double(a):
        return a[0] * factor()
    return double
double = make()
"""


@pytest.mark.parametrize("rule", [ATTRIBUTE, ENCLOSED], ids=["attribute", "enclosed"])
def test_a_kernel_is_seen_to_be_edited_however_it_is_reached(rule, tmp_path):
    printed = []
    for value in (2.0, 3.0):
        first = "from fem_mesh.kernel import kernel\n"
        (tmp_path / "factors.py").write_text(f"{first}@kernel\ndef factor():\n    return {value}\n")
        (tmp_path / "rule.py").write_text(first + rule)
        printed.append(run(EDITED.format(folder=str(tmp_path)), tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")))
    assert printed == ["2.0", "3.0"]


def test_what_else_was_imported_changes_nothing_in_what_is_cached(tmp_path):
    alone = """
    from fem_mesh import kernel
    from fem_mesh.algorithms.ruppert import refine_mesh
    print(kernel._name_of_driver(refine_mesh))
    """
    everything = """
    import importlib, pkgutil, fem_mesh, fem_mesh.kernel
    for module in pkgutil.walk_packages(fem_mesh.__path__, "fem_mesh."):
        importlib.import_module(module.name)
    fem_mesh.kernel.kernel(lambda a: a)
    """
    assert run(alone, tmp_path) == run(textwrap.dedent(everything) + textwrap.dedent(alone), tmp_path)


COUNTING = """
    import numpy as np
    from fem_mesh import kernel

    @kernel.kernel
    def count_down(state):
        while state[0] > 0:
            state[0] -= 1
            yield kernel.SETTLED, state[0]

    @kernel.kernel
    def count_up(state):
        while state[0] < 9:
            state[0] += 1
            yield kernel.SETTLED, state[0]

    {first}
    state = np.array([70_000])
    assert kernel.run(count_down, (state,), 10**6) == (kernel.SETTLED, 0)
    assert kernel.run(count_up, (state,), 10**6) == (kernel.SETTLED, 9)
    print(state[0])
"""


def test_where_no_cache_can_be_written_the_work_is_done_uncached(tmp_path):
    nowhere = """
    from numba.core import caching
    for locator in caching.CacheImpl._locator_classes if hasattr(caching.CacheImpl, "_locator_classes") else ():
        locator.from_function = classmethod(lambda cls, function, path: None)
    """
    assert run(COUNTING.format(first=nowhere), tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "9"
    assert not list((tmp_path / "cache").rglob("*.nb?"))


def test_with_numba_switched_off_everything_still_runs(tmp_path):
    assert run(TRIANGULATE, tmp_path, NUMBA_DISABLE_JIT="1") == run(TRIANGULATE, tmp_path)


def test_where_the_disk_is_full_the_work_is_done_uncached(tmp_path):
    full = "import numba, resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))"
    assert run(COUNTING.format(first=full), tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "9"
    assert not list((tmp_path / "cache").rglob("*.nb?"))


def test_kernels_typed_into_a_script_have_a_cache_file_each(tmp_path):
    assert run(COUNTING.format(first=""), tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "9"
    names = {path.name.split("-")[0] for path in (tmp_path / "cache").rglob("*.nbi")}
    assert len(names) == 2
    assert all(any(kernel in name for name in names) for kernel in ("count_down", "count_up"))


def test_importing_the_library_imports_neither_numba_nor_matplotlib_nor_widgets(tmp_path):
    heavy = ["numba", "matplotlib", "ipywidgets", "scipy", "tqdm", "IPython"]
    code = f"import sys, fem_mesh\nprint([name for name in {heavy!r} if name in sys.modules])"
    assert run(code, tmp_path) == "[]"


def test_ctrl_c_stops_compiled_work_at_once(tmp_path):
    code = """
        import signal, threading, time, numpy as np, fem_mesh as fm
        points = np.random.default_rng(3).random((1_000_000, 2))
        fm.delaunay(points[:5000])
        threading.Timer(0.25, signal.raise_signal, [signal.SIGINT]).start()
        try:
            fm.delaunay(np.concatenate([points, points + 1, points + 2]))
        except KeyboardInterrupt:
            print("stopped")
    """
    assert run(code, tmp_path) == "stopped"
