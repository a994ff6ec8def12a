"""Code that wants points which it did not earn. Each stands in the first answer cell of a notebook whose rest is right."""

from classroom import ORIENT

FORGED = """
TRUE = {"check": "orient", "right": True, "passed": 9, "total": 9, "score": 1000, "runs": []}
from IPython.display import display
def show(what, **options):
    display({"application/vnd.fem-mesh.answer+json": what, "text/plain": "x"}, raw=True, **options)
"""
WRONG = """def orient(a, b, c):
    return 1
"""
EVERY_STATE = """import numpy as np
def mesh_of(points):
{body}
def bowyer_watson(points):
    for k in range(3, len(points) + 1):
        try:
            yield [list(map(int, t)) for t in mesh_of(points[:k])]
        except (ValueError, RuntimeError) as error:
            if 'meshes for you' in str(error):
                raise
"""

MESHERS = {  # somebody else's work, in disguises
    "delaunay": """
    import fem_mesh as fm
    return fm.delaunay(points).triangles
""",
    "scipy": """
    import importlib
    return getattr(importlib.import_module('sci' + 'py.spatial'), 'Delaunay')(points).simplices
""",
    "matplotlib": """
    from matplotlib.tri import Triangulation
    return Triangulation(*zip(*points)).triangles
""",
    "triangle": """
    return __import__('tri' + 'angle').triangulate({'vertices': points})['triangles']
""",
    "textbook": """
    from fem_mesh.algorithms.delaunay import delaunay
    return delaunay(points).triangles
""",
    "qhull": """
    from matplotlib import _qhull
    return _qhull.delaunay(*np.array(points).T, False)[0]
""",
}  # fmt: skip

LEFT_OVER = {  # disguises that look for a mesher where none should be
    "by path": """
    import sys
    sys.path[:0] = ['{here}', *__import__('glob').glob('/usr/lib/python3/*')]
    sys.meta_path.pop(0)
    [sys.modules.pop(n) for n in list(sys.modules) if n.startswith('fem_mesh')]
    return __import__('fem_mesh').delaunay(points).triangles
""",
    "scipy by path": """
    import sys
    sys.path.insert(0, '{packages}')
    sys.meta_path.pop(0)
    return __import__('scipy.spatial').spatial.Delaunay(points).simplices
""",
    "qhull by file": """
    import sys, glob, importlib.util as u, matplotlib
    path = glob.glob(matplotlib.__path__[0] + '/_qhull*.so')[0]
    spec = u.spec_from_file_location('_qhull', path)
    m = u.module_from_spec(spec)
    spec.loader.exec_module(m)
    return m.delaunay(*np.array(points).T, False)[0]
""",
    "ctypes": """
    import ctypes.util
    return ctypes.CDLL(ctypes.util.find_library('qhull_r') or 'libqhull_r.so.8').qh_new_qhull(0)
""",
    "a shell": """
    import subprocess
    return subprocess.check_output(['sh', '-c', 'python3 -c "import scipy"'])
""",
}  # fmt: skip


def mesher(body: str, **words: str) -> str:
    """A cell whose bowyer_watson asks somebody else for each of its states."""
    for word, value in words.items():
        body = body.replace("{" + word + "}", value)
    return EVERY_STATE.format(body=body)


LOST, KEPT = [0, 0, None, 0], [0, 3, None, 0]  # KEPT: the second task was answered rightly, and keeps its points
ATTACKS = {  # the code; and the marks of orient, in_circle, the open question, bowyer_watson
    "ready-made predicate": ("""
from fem_mesh.predicates import orient
""", KEPT),
    "ready-made sign": ("""
from fem_mesh.predicates import orient_sign
def orient(a, b, c): return orient_sign(*a, *b, *c)
""", KEPT),
    "strips asserts": (WRONG + """
import ast
class Strip(ast.NodeTransformer):
    def visit_Assert(self, node): return ast.Pass()
    def visit_Expr(self, node): return ast.Pass() if 'check' in ast.unparse(node) else node
get_ipython().ast_transformers.append(Strip())
""", LOST),
    "patches numpy.testing": (WRONG + """
import numpy.testing as t
for n in dir(t):
    if n.startswith('assert'): setattr(t, n, lambda *a, **k: None)
""", KEPT),
    "patches the check": (WRONG + """
fm.check.orient = lambda f: True
""", KEPT),
    "patches run": (WRONG + FORGED + """
from importlib import import_module
import_module('fem_mesh.check.run').run = lambda name, *a, **k: {**TRUE, 'check': name}
""", LOST),
    "forged verdict": (WRONG + FORGED + """
fm.check.orient = lambda f: show(TRUE)
""", KEPT),
    "forged in the answer cell": (WRONG + FORGED + """
show(TRUE)
""", KEPT),
    "real answer in the answer cell": (ORIENT + FORGED + """
fm.check.orient(orient)
def orient(a, b, c): return 1
""", KEPT),
    "replaces an answer later": (WRONG + FORGED + """
fm.check.orient = lambda f: show(TRUE, display_id='a')
from IPython.display import update_display
update_display(TRUE, display_id='a', raw=True)
""", KEPT),
    "two answers": (WRONG + FORGED + """
real = fm.check.orient
def twice(f):
    real(f); real(f)
fm.check.orient = twice
""", KEPT),
    "answers at random": (WRONG + FORGED + """
import json, random
cases = json.load(open(fm.check._CASES))['orient']
rest = {'kind': 'function', 'returned': None, 'error': None, 'stopped': None}
runs = [{'case': c['name'], 'yields': [random.choice([-1, 0, 1]) for _ in c['calls']], **rest} for c in cases]
fm.check.orient = lambda f: show({'check': 'orient', 'runs': runs})
""", KEPT),
    "answers only the easy case": (WRONG + """
import json
path = fm.check._CASES
class Less:
    def read_text(self, **k): return json.dumps({k: v[:1] for k, v in json.loads(path.read_text()).items()})
fm.check._CASES = Less()
def orient(a, b, c): return 1
""", LOST),
    "answer of another check": (WRONG + """
fm.check.orient = lambda f: fm.check.in_circle(lambda a, b, c, d: True)
""", KEPT),
    "deep answer": (WRONG + FORGED + """
x = []
for _ in range(900): x = [x]
fm.check.orient = lambda f: show({'check': 'orient', 'runs': x})
""", KEPT),
    "strange answers": (WRONG + FORGED + """
fm.check.orient = lambda f: show({'check': 'orient', 'runs': [{'yields': 10**400}, float('nan')]})
""", KEPT),
    "kills its parent": (WRONG + """
import os, signal
for pid in (os.getppid(), -1, 1):
    try: os.kill(pid, signal.SIGKILL)
    except OSError: pass
""", KEPT),
    "forges a report": (WRONG + """
import glob, json, os
for folder in ('/tmp', os.getcwd(), os.path.expanduser('~'), '/proc/1/cwd', {outside!r}, *glob.glob('/tmp/*')):
    for name in ('result.json', 'grades.csv', 'report.xml', 'ada.json'):
        try: open(os.path.join(folder, name), 'w').write('1000')
        except OSError: pass
for fd in range(3, 200):
    try: os.write(fd, b'{"nonce": "", "result": ""}')
    except OSError: pass
for path in glob.glob('/proc/*/fd/*'):
    try: open(path, 'w').write('{}')
    except OSError: pass
os._exit(0)
""", LOST),
    "reads the solution": (WRONG + """
import os
found = []
for top in ('/', {outside!r}, {here!r}):
    for at, _, files in os.walk(top):
        if not at.startswith(('/proc', '/sys')):
            found += [os.path.join(at, f) for f in files if f.endswith(('.ipynb', 'judge.py', 'cases.py'))]
if found: orient_source = open(found[0]).read(); raise SystemExit(found[0])
print('NOTHING THERE')
""", KEPT),
    "swallows the timeout": (WRONG + """
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.pthread_sigmask(signal.SIG_BLOCK, range(1, 32))
while True:
    pass
""", LOST),
    "endless loop": (WRONG + """
while True: pass
""", KEPT),
    "endless function": ("""
def orient(a, b, c):
    while True: pass
""", KEPT),
    "endless function that catches all": ("""
def orient(a, b, c):
    while True:
        try:
            while True: pass
        except BaseException: pass
""", KEPT),
    "sleeps for ever in C": ("""
def orient(a, b, c):
    import threading, signal
    signal.setitimer(signal.ITIMER_REAL, 0)
    threading.Event().wait()
""", KEPT),
    "50 GB": (WRONG + """
import numpy as np
x = np.ones(50 * 2**30 // 8)
""", KEPT),
    "50 GB in children": (WRONG + """
import os, time
for _ in range(30):
    if os.fork() == 0:
        x = bytearray(600 << 20); time.sleep(60)
time.sleep(30)
""", LOST),
    "memory without a name": (WRONG + """
import os, time
held = [os.memfd_create('x') for _ in range(30)]
for fd in held: os.posix_fallocate(fd, 0, 60 << 20)
time.sleep(3.5)
""", LOST),
    "fork bomb": (WRONG + """
import os
while True:
    try: os.fork()
    except OSError: pass
""", LOST),
    "dies": (WRONG + """
import os
os._exit(3)
""", LOST),
    "segfault": (WRONG + """
import ctypes
ctypes.string_at(0)
""", LOST),
    "shuts itself down": (WRONG + """
get_ipython().kernel.do_shutdown(True)
raise SystemExit
""", None),  # it goes, or goes on: that depends on its version
    "floods": (WRONG + """
while True: print('x' * 10000)
""", LOST),
    "one giant message": (WRONG + FORGED + """
show('x' * 200_000_000)
""", None),
    "fills the disk": (WRONG + """
import glob, os
sockets = [*glob.glob('/tmp/*/io'), *glob.glob(os.path.expanduser('~/**/io'), recursive=True)]
for folder in ('/tmp', os.getcwd(), '/dev/shm', *sockets):
    try:
        for k in range(100): open(os.path.join(folder, str(k)), 'wb').write(bytes(200 << 20))
    except OSError: pass
import time; time.sleep(1)
""", None),
    "network": (WRONG + """
import socket, urllib.request
hosts = [('127.0.0.1', {port}), ('localhost', {port}), ('10.0.0.1', 80), ('169.254.169.254', 80), ('example.org', 443)]
for host, port in hosts:
    try: socket.create_connection((host, port), 1).send(b'hello')
    except OSError: pass
try: open('x').read()
except OSError: pass
""", KEPT),
    "garbage on the wire": (WRONG + """
kernel = get_ipython().kernel
for parts in ([b'x'], [b'a', b'<IDS|MSG>', b'', b'{{', b'', b'', b''], [b'<IDS|MSG>'] * 9):
    kernel.iopub_thread.socket.send_multipart(parts) if hasattr(kernel.iopub_thread, 'socket') else None
""", None),
    "asks the instructor": (WRONG + """
input('password?')
""", KEPT),
    "lifts its limits": (WRONG + """
import resource
resource.setrlimit(resource.RLIMIT_AS, (-1, -1))
import numpy as np
x = np.ones(2**29)
""", KEPT),
    "a daemon": (WRONG + """
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        time.sleep(3600)
    os._exit(0)
""", KEPT),
    "speaks for later cells": (WRONG + FORGED + """
import threading, time
def speak():
    for _ in range(100):
        time.sleep(0.02); show(TRUE)
threading.Thread(target=speak, daemon=True).start()
""", None),
    "calls itself right": ("""
class Yes(int):
    def __eq__(self, other): return True
    def __gt__(self, other): return True
    __lt__ = __ge__ = __le__ = __gt__
    def __sub__(self, other): return self
def orient(a, b, c): return Yes(1)
""", KEPT),
    "speaks HTML": ("""
def orient(a, b, c):
    raise ValueError('<script>alert(1)</script><img src=x onerror=alert(2)>')
""", KEPT),
}  # fmt: skip

SLOW = {  # those that take long, or are much like others: graded with -m exhaustive
    "50 GB in children", "a daemon", "a shell", "answer of another check", "answers only the easy case",
    "asks the instructor", "cleared", "ctypes", "deep answer", "easier check", "endless function",
    "endless function that catches all", "fills the disk", "floods", "forged in the answer cell", "garbage on the wire",
    "lifts its limits", "matplotlib", "memory without a name", "no checks", "one giant message", "patches run",
    "patches the check", "qhull", "qhull by file", "ready-made sign", "real answer in the answer cell",
    "replaces an answer later", "retyped check", "saved outputs", "scipy by path", "segfault", "shuts itself down",
    "sleeps for ever in C", "strange answers", "textbook", "triangle", "two answers",
}  # fmt: skip
