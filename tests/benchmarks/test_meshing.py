"""How few triangles, how far the bound goes, how fast: beside Triangle (PyPI's ``triangle``). Nothing here can fail on time."""

import functools
import gc
import pathlib
import statistics
import subprocess
import sys
import time

import pytest
import triangle
from fresh import peak_memory
from outlines import DOMAINS, l_shape, plate, zigzag

import fem_mesh as fm

HERE = str(pathlib.Path(__file__).parent)
TIME_LIMIT = 20  # seconds, for Triangle, which has no budget of its own
PLENTY = 200_000  # vertices, for ours


def as_domain(outline):
    return fm.Domain(*outline)


def as_dict(outline):
    points, segments, holes = outline
    given = {"vertices": points, "segments": segments}
    return given | ({"holes": holes} if len(holes) else {})


def triangulate(outline, flags):
    return triangle.triangulate(as_dict(outline), flags)


# ---- how few triangles, and how far the bound goes -----------------------------------------------------


@pytest.mark.parametrize("angle", [20, 25, 30, 33])
@pytest.mark.parametrize("make", DOMAINS, ids=lambda make: make.__name__)
def test_triangles_needed(line, make, angle):
    mesh = fm.refine(as_domain(make()), min_angle=angle)
    theirs = triangles_of_triangle(make.__name__, angle)
    ours = f"{len(mesh.triangles):,}" + ("" if mesh.refinement.complete else " (incomplete)")
    peer = f"{theirs:,}" if theirs else f"not in {TIME_LIMIT} s"
    ratio = f"{len(mesh.triangles) / theirs:.2f}" if theirs else ""
    line(f"triangles, {make.__name__}, {angle} degrees", ours, peer, ratio, "<= 1.0, aim 0.9")


ALONE = """
import sys
sys.path.insert(0, {here!r})
import outlines, triangle
points, segments, holes = outlines.{name}()
given = dict(vertices=points, segments=segments)
if len(holes):
    given["holes"] = holes
print(len(triangle.triangulate(given, "pq{angle}Q")["triangles"]))
"""


@functools.cache
def triangles_of_triangle(name, angle):
    """How many triangles Triangle makes, in a process of its own; 0 if it does not end in time."""
    code = ALONE.format(here=HERE, name=name, angle=angle)
    try:
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        return 0
    return int(done.stdout) if done.returncode == 0 and done.stdout.strip() else 0


def ends(make, angle):
    return fm.refine(as_domain(make()), min_angle=angle, max_points=PLENTY).refinement.complete


def largest(is_kept, low=330, high=380):
    """The largest tenth of a degree from 33 to 38 such that it and all below it on the grid are kept; 0 if none."""
    kept = 0
    for tenths in range(low, high + 1):
        if not is_kept(tenths / 10):
            break
        kept = tenths / 10
    return kept


def test_largest_bound_for_which_all_four_end(line):
    ours = largest(lambda angle: all(ends(make, angle) for make in DOMAINS))
    theirs = largest(lambda angle: all(triangles_of_triangle(make.__name__, angle) for make in DOMAINS))
    line(
        "largest bound for which all four domains end",
        f"{ours:.1f}",
        f"{theirs:.1f}",
        f"{ours - theirs:+.1f}",
        ">= 34.2, aim 36",
    )


# ---- how fast ------------------------------------------------------------------------------------------


def area_for(triangles, outline, angle):
    """The area bound that gives about so many triangles: found with Triangle, by two corrections."""
    area = 2.0 / triangles
    for _ in range(3):
        area *= len(triangulate(outline, f"pq{angle}a{area:.17f}Q")["triangles"]) / triangles
    return area


@pytest.mark.parametrize("angle", [20, 30])
@pytest.mark.parametrize("make", [l_shape, plate], ids=lambda make: make.__name__)
@pytest.mark.parametrize("triangles", [100_000, 1_000_000])
def test_refinement_by_area_beside_triangle(compare, line, triangles, make, angle):
    outline = make()
    area = area_for(triangles, outline, angle)
    domain, flags = as_domain(outline), f"pq{angle}a{area:.17f}Q"
    options = {"min_angle": angle, "max_area": area, "max_points": 4 * triangles}
    what = f"refine, {make.__name__}, {angle} degrees, {triangles:,}"
    rounds = 7 if triangles < 1_000_000 else 3
    compare(what, lambda: fm.refine(domain, **options), lambda: triangulate(outline, flags), "<= 0.8, aim 0.6", rounds)
    ours, theirs = len(fm.refine(domain, **options).triangles), len(triangulate(outline, flags)["triangles"])
    line(f"  its triangles, at the same area bound {area:.3g}", f"{ours:,}", f"{theirs:,}", f"{ours / theirs:.2f}", "")


def test_growth_from_ten_thousand_to_a_million_triangles(line):
    micro = {}
    for n in (10_000, 100_000, 1_000_000):
        outline = l_shape()
        domain, area = as_domain(outline), area_for(n, outline, 30)
        fm.refine(domain, min_angle=30, max_area=area, max_points=4 * n)
        times = []
        for _ in range(max(3, 100_000 // n)):
            gc.collect()
            start = time.process_time()
            mesh = fm.refine(domain, min_angle=30, max_area=area, max_points=4 * n)
            times.append(time.process_time() - start)
        micro[n] = statistics.median(times) / len(mesh.triangles) * 1e6
    shown = ", ".join(f"{t:.2f}" for t in micro.values())
    line("time a triangle at 1e4, 1e5, 1e6", f"{shown} us", "", f"{micro[1_000_000] / micro[10_000]:.2f}", "<= 1.5")


def test_cdt_of_ten_thousand_segments_beside_triangle(compare):
    outline = zigzag(10_000)
    domain = as_domain(outline)
    what = "constrained_delaunay, 10,000 segments"
    compare(what, lambda: fm.constrained_delaunay(domain), lambda: triangulate(outline, "pQ"), "<= 1.0")


def test_domain_and_cdt_of_ten_thousand_segments_beside_triangle(compare):
    outline = zigzag(10_000)
    what = "Domain and constrained_delaunay, 10,000 segments"
    compare(what, lambda: fm.constrained_delaunay(as_domain(outline)), lambda: triangulate(outline, "pQ"), "")


def steps_to(triangles, domain, angle):
    """Record the refinement in plain Python until so many triangles are there: by an area bound found before."""
    area = 2.0 * 3 / triangles
    for _ in range(4):
        area *= len(fm.refine(domain, min_angle=angle, max_area=area).triangles) / triangles
    start = time.process_time()
    trace = fm.record(fm.ruppert(domain, min_angle=angle, max_area=area), limit=None)
    return time.process_time() - start, trace


def test_recording_the_l_shape_to_five_hundred_triangles(line):
    domain = as_domain(l_shape())
    seconds, trace = min((steps_to(500, domain, 30) for _ in range(3)), key=lambda result: result[0])
    what = f"ruppert recorded, L-shape, 30 degrees, {len(trace.mesh.triangles)} triangles, {len(trace):,} steps"
    line(what, f"{seconds * 1e3:.0f} ms", "", "", "<= 2 s")


# ---- in fresh processes --------------------------------------------------------------------------------


def test_peak_memory_of_a_million_triangles(line):
    before = (
        f"import sys; sys.path.insert(0, {HERE!r}); import outlines, fem_mesh as fm;"
        "domain = fm.Domain(*outlines.l_shape()); fm.refine(domain, min_angle=20, max_area=1e-3)"
    )
    area = area_for(1_000_000, l_shape(), 20)
    work = f"mesh = fm.refine(domain, min_angle=20, max_area={area!r}); count = len(mesh.triangles)"
    line("peak memory, 1,000,000 triangles", f"{peak_memory(before, work, 3):.0f} bytes a triangle", "", "", "<= 400")
