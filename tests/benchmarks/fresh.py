"""Measurements in processes of their own."""

import statistics
import subprocess
import sys


def fresh(code, runs=5):
    """The number that ``code`` prints in a fresh process, the median of ``runs``, after one to warm up."""

    def run():
        return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)

    run()
    return statistics.median(run() for _ in range(runs))


def peak_memory(before, work, runs=5):
    """Bytes at the peak of ``work``, statements that set ``count``, beyond those after ``before``; a count of things."""
    return fresh(MEMORY.format(before=before, work=work), runs)


MEMORY = """
import threading, psutil
{before}
process = psutil.Process()
base = peak = process.memory_info().rss
done = threading.Event()
def watch():
    global peak
    while not done.wait(0.001):
        peak = max(peak, process.memory_info().rss)
watcher = threading.Thread(target=watch)
watcher.start()
{work}
peak = max(peak, process.memory_info().rss)
done.set(); watcher.join()
print((peak - base) / count)
"""
