"""A notebook in JupyterLab, driven as its reader would: opened, run, restarted, asked."""

import ast
import json
import secrets
import time
from pathlib import Path

# Every script sees the notebook that is open under these names.
NAMES = """
const panel = jupyterapp.shell.currentWidget, notebook = panel.content, session = panel.context.sessionContext;
const cells = notebook.widgets.filter(cell => cell.model.type === "code");
// From the model: a cell out of sight may not have been drawn yet.
const prompt = ({model}) => model.executionState === "running" ? "*" : String(model.executionCount ?? " ");
const blank = cell => !cell.model.sharedModel.getSource().trim();
const connected = () => session.session?.kernel?.connectionStatus === "connected";
const idle = () => connected() && session.session.kernel.status === "idle";
"""
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}


def js(page, body, argument=None):
    """What a JavaScript function returns that sees the open notebook: `panel`, `notebook`, `session`, `cells`."""
    return page.evaluate(f"async argument => {{ {NAMES} return await ({body})(argument); }}", argument)


def wait_until(page, body, argument=None, *, seconds=60.0):
    """Wait until such a function returns something true, and return that."""
    last = time.monotonic() + seconds
    while not (value := js(page, body, argument)):
        if time.monotonic() > last:
            raise AssertionError(f"waited {seconds} s for {body}; prompts: {js(page, '() => cells.map(prompt)')}")
        page.wait_for_timeout(20)
    return value


def open_notebook(page, cells=(), *, name="test.ipynb", path=None, trusted=False):
    """Write a notebook into the lab and open it, alone on the page; nothing is run yet.

    Its cells are texts (of code) or nbformat's dictionaries; or, with ``path``, it is a copy of an existing one.
    """
    notebook = json.loads(Path(path).read_text()) if path else {"cells": [], "nbformat": 4, "nbformat_minor": 5}
    code = {"cell_type": "code", "execution_count": None, "outputs": []}
    for k, cell in enumerate(cells):
        plain = code | {"source": cell} if isinstance(cell, str) else cell
        notebook["cells"].append({"id": f"cell{k}", "metadata": {}} | plain)
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["metadata"]["trusted"] = trusted
    # Trust goes by content: a copy of what was run here would be trusted without being asked for.
    notebook["metadata"] = {"kernelspec": KERNEL, "copy": secrets.token_hex(8)}
    put = page.request.put(f"/api/contents/{name}", data={"type": "notebook", "format": "json", "content": notebook})
    assert put.ok, put.text()
    # The kernel starts while the page loads.
    page.request.post("/api/sessions", data={"path": name, "name": name, "type": "notebook", "kernel": KERNEL})
    if is_tidy(page):
        close_notebooks(page)
        page.evaluate("path => { void jupyterapp.commands.execute('docmanager:open', {path, factory: 'Notebook'}); }", name)
    else:
        page.goto(f"/doc/tree/{name}?reset")
    wait_open(page, name)


def wait_open(page, name="test.ipynb"):
    """Wait until the notebook is on the page: after ``page.reload()``, too."""
    there = """name => {
        const panel = window.jupyterapp?.shell.currentWidget;
        return panel?.context?.path === name && panel.content.widgets.length;
    }"""
    page.wait_for_function(there, arg=name)
    wait_until(page, "() => panel.isVisible && panel.context.isReady && cells.every(prompt)")


def is_tidy(page):
    """Is this a lab in its light theme, where a notebook can be opened as if it was new?"""
    return page.evaluate("() => !!window.jupyterapp && document.body.dataset.jpThemeLight === 'true'")


def close_notebooks(page):
    """Close what is open, unsaved, and end its kernel."""
    page.evaluate("""async () => {
        for (const panel of [...jupyterapp.shell.widgets("main")].filter(panel => panel.context)) {
            await panel.context.sessionContext.shutdown();
            panel.dispose();
        }
    }""")


def cell(page, i):
    """The i-th code cell on the page, with its outputs (a playwright Locator)."""
    return page.locator(".jp-Notebook .jp-CodeCell").nth(i)


def run_all(page, *, errors=False):
    """Run all cells and return the texts of their outputs. An error fails the test, unless ``errors`` allows it
    (the cells below it were run or not: JupyterLab and the kernel race for that).

    Texts are what was printed and ``text/plain``; a widget's view may still be on its way: wait for its element.
    """
    return _run(page, "notebook:run-all-cells", None, errors)


def run_cell(page, i, *, errors=False):
    """Run the i-th code cell again, and return its output's text."""
    js(page, "i => { notebook.activeCellIndex = notebook.widgets.indexOf(cells[i]); notebook.deselectAll(); }", i)
    return _run(page, "notebook:run-cell", [i], errors)[0]


def _run(page, command, which, errors):
    chosen = "cells.filter((cell, k) => (argument ?? [k]).includes(k))"
    filled = f"{chosen}.filter(cell => !blank(cell))"
    wait_until(page, "idle")
    js(page, f"argument => {filled}.forEach(cell => {{ cell.model.executionCount = null; }})", which)
    _start(page, command, f"argument => {filled}.some(cell => prompt(cell) !== ' ') || !{filled}.length", which)
    wait_until(page, f"argument => idle() && {chosen}.every(cell => prompt(cell) !== '*')", which, seconds=120)
    outputs = js(page, f"argument => {chosen}.map(cell => cell.model.outputs.toJSON())", which)
    failed = [output for cell in outputs for output in cell if output["output_type"] == "error"]
    if failed and not errors:
        raise AssertionError("a cell failed:\n" + "\n".join(failed[0]["traceback"]))
    left = js(page, f"argument => {filled}.filter(cell => prompt(cell) === ' ').length", which)
    assert failed or not left, f"{left} cells were not run"
    return ["\n".join(map(_text, cell)) for cell in outputs]


def _start(page, command, started, argument):
    """Send a command until it has an effect: JupyterLab drops one that comes too soon after a kernel's start."""
    for _ in range(20):
        page.evaluate("command => { void jupyterapp.commands.execute(command); }", command)
        try:
            return wait_until(page, started, argument, seconds=2)
        except AssertionError:
            continue
    raise AssertionError(f"{command} has no effect")


def _text(output):
    if output["output_type"] == "error":
        return f"{output['ename']}: {output['evalue']}"
    text = output["text"] if "text" in output else output.get("data", {}).get("text/plain", "")
    return text if isinstance(text, str) else "".join(text)


def restart_kernel(page):
    """A new kernel: nothing of the old one is left, the outputs on the page stay."""
    js(page, "() => session.restartKernel().then(() => null)")
    wait_until(page, "idle")


def python(page, expression, *, code="", seconds=30):
    """The repr of an expression in the notebook's kernel, after ``code`` was run there; no cell is touched.

    Comm messages that the page sent before are dealt with before: after a click, ask at once.
    """
    ask = """async ([code, expression, seconds]) => {
        const reply = session.session.kernel.requestExecute(
            {code, silent: true, store_history: false, user_expressions: {repr: `repr((${expression}\\n))`}});
        const late = new Promise((_, no) => setTimeout(() => no(Error(`no answer for ${expression}`)), 1000 * seconds));
        return (await Promise.race([reply.done, late])).content;
    }"""
    wait_until(page, "connected")
    answer = js(page, ask, [code, expression, seconds])
    told = answer["user_expressions"]["repr"] if answer["status"] == "ok" else answer
    assert told["status"] == "ok", f"{expression}: {told['ename']}: {told['evalue']}"
    return ast.literal_eval(told["data"]["text/plain"])


def save(page):
    """Save the notebook as it is on the page."""
    js(page, "() => panel.context.save()")


def set_theme(page, theme):
    """Switch the lab to "JupyterLab Dark" or "JupyterLab Light", and wait until it has."""
    if page.evaluate("document.body.dataset.jpThemeName") == theme:
        return
    with page.expect_response(lambda answer: "/api/settings/" in answer.url and answer.request.method == "PUT"):
        page.evaluate("theme => { void jupyterapp.commands.execute('apputils:change-theme', {theme}); }", theme)
    page.wait_for_function("theme => document.body.dataset.jpThemeName === theme", arg=theme)
    page.wait_for_selector("#jupyterlab-splash", state="detached")  # two of them stumble over each other
