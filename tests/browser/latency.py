"""How long a reader waits: from a pointer's event to the frame that shows what it changed."""

import statistics
from dataclasses import dataclass

# A widget's root counts its redraws in `data-drawn`. The answer is there when the watched value has changed and a
# redraw came in the same batch of changes or in a later one; the next frame's start is when it can be seen.
WATCH = """([selector, watch, event, seconds]) => {
    const root = document.querySelector(selector), value = eval(watch);
    window.femLatency = new Promise((resolve, reject) => {
        const late = setTimeout(() => finish(reject, Error(`no answer to ${event} in ${seconds} s`)), 1000 * seconds);
        let start = null, before = null, changed = false;
        const finish = (how, what) => {
            clearTimeout(late);
            observer.disconnect();
            removeEventListener(event, begin, true);
            how(what);
        };
        const begin = () => {
            if (start === null) [start, before] = [performance.now(), String(value(root))];
        };
        const observer = new MutationObserver(records => {
            if (start === null) return;
            changed ||= String(value(root)) !== before;
            if (changed && records.some(record => record.target === root && record.attributeName === "data-drawn")) {
                observer.disconnect();
                requestAnimationFrame(() => finish(resolve, performance.now() - start));
            }
        });
        addEventListener(event, begin, true);
        observer.observe(root, {subtree: true, childList: true, characterData: true, attributes: true});
    });
    window.femLatency.catch(() => null);
}"""


@dataclass(frozen=True)
class Latency:
    """Milliseconds from event to frame: the median, the quartiles around it, and every time measured."""

    low: float
    median: float
    high: float
    times: tuple[float, ...]

    def __str__(self) -> str:
        return f"{self.median:.1f} ms (quartiles {self.low:.1f} to {self.high:.1f}, {len(self.times)} times)"


def measure(page, act, watch, *, root="[data-drawn]", event="pointerdown", times=20, warm=2, pause=0.25, seconds=20.0):
    """Call ``act(k)``, which makes a pointer's event, and time the answer; ``warm`` first times do not count.

    ``pause`` seconds pass between two events, as in a reader's hand. Without them a kernel's answer takes some 25 ms
    longer: Jupyter's server leaves Nagle's algorithm on, which waits for a delayed acknowledgement.

    ``watch`` is a JavaScript function of the root element: its value tells the old state from the new,
    as in ``"root => root.querySelector('.fem-points').textContent"``.
    """
    taken = []
    for k in range(warm + times):
        page.evaluate(WATCH, [root, watch, event, seconds + pause])
        page.wait_for_timeout(1000 * pause)
        act(k)
        taken.append(page.evaluate("() => window.femLatency"))
    low, median, high = statistics.quantiles(taken[warm:], n=4, method="inclusive")
    return Latency(low, median, high, tuple(taken[warm:]))
