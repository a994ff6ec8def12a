"""Each measurement is a line of a table: what, ours, the peer's in the same process, their ratio, what to reach."""

import statistics
import time

import pytest

LINES = []


@pytest.fixture
def line(request):
    """Add a line to the table that is printed at the end."""

    def add(what, ours, peer="", ratio="", reach=""):
        LINES.append((what, ours, peer, ratio, reach))

    return add


@pytest.fixture
def compare(benchmark, line):
    """Time ``ours`` and ``peer`` in turn, in CPU seconds; medians and the ratio of the medians go to the table."""

    def measure(what, ours, peer, reach, rounds=7):
        peers = []

        def run_peer():
            start = time.process_time()
            peer()
            peers.append(time.process_time() - start)

        ours()
        benchmark.pedantic(ours, setup=run_peer, rounds=rounds, warmup_rounds=1)
        mine, theirs = benchmark.stats.stats.median, statistics.median(peers[1:])
        benchmark.extra_info["ratio"] = mine / theirs
        line(what, f"{mine * 1e3:.1f} ms", f"{theirs * 1e3:.1f} ms", f"{mine / theirs:.2f}", reach)

    return measure


def pytest_configure(config):
    config.option.benchmark_timer = "time.process_time"


def pytest_terminal_summary(terminalreporter):
    if LINES:
        rows = [("what", "fem_mesh", "peer", "ratio", "to reach"), *LINES]
        widths = [max(len(str(row[i])) for row in rows) for i in range(5)]
        terminalreporter.section("measured, CPU time, medians")
        for row in rows:
            terminalreporter.write_line("  ".join(str(value).ljust(width) for value, width in zip(row, widths, strict=True)))
