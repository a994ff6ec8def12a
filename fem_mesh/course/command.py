"""The command ``fem-mesh``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from fem_mesh.course import notebooks as lessons
from fem_mesh.course.homework.command import homework
from fem_mesh.course.notebooks import NotebookError
from fem_mesh.steps import many

NOTEBOOKS = click.argument("notebooks", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))


@click.group()
def main() -> None:
    """Notebooks of a course: blank copies to type into, runs as they are kept, homework and its marks."""


main.add_command(homework)


@main.command()
@NOTEBOOKS
@click.option("-o", "--output", "folder", required=True, type=click.Path(file_okay=False, path_type=Path),
              help="The folder for the copies; it is made if it is not there.")  # fmt: skip
@click.option("--force", is_flag=True, help="Write over copies that are there.")
def blank(notebooks: Sequence[Path], folder: Path, force: bool) -> None:
    """Write copies of NOTEBOOKS to type into, in a lecture.

    Prose stays, without the folded solutions of exercises. The imports stay (the first code cell), and cells tagged
    "keep". All other code cells are empty. The notebooks themselves are never written over.
    """
    copies: dict[Path, str] = {}
    for path in notebooks:
        copy = folder.resolve() / path.name  # as it will be when the folder is made
        if copy.exists() and any(copy.samefile(source) for source in notebooks):
            raise NotebookError(f"{copy} is the notebook itself: name another folder")
        if copy in copies:
            raise NotebookError(f"two of the notebooks are called {path.name}: give each a folder of its own")
        if copy.exists() and not force:
            raise NotebookError(f"{copy} is there already: name another folder, or say --force")
        copies[copy] = lessons.text(lessons.blank(lessons.read(path)))
    folder.mkdir(parents=True, exist_ok=True)
    for copy, text in copies.items():
        copy.write_text(text, encoding="utf-8", newline="\n")
        click.echo(f"wrote {folder / copy.name}")


@main.command()
@NOTEBOOKS
@click.option("--timeout", default=600, show_default=True, help="Seconds that a cell may take.")
def run(notebooks: Sequence[Path], timeout: int) -> None:
    """Run NOTEBOOKS in place, and save them as they are kept.

    Each runs in its folder, from a fresh kernel of this Python. Outputs are saved without what would change in the
    next run: run times, and models of widgets (the pictures beside them stay). A notebook in which a cell fails
    is left as it was.
    """
    for path in notebooks:
        notebook = lessons.read(path)
        lessons.run(notebook, path, timeout)
        text, before = lessons.text(notebook), path.read_text(encoding="utf-8")
        if text != before:
            path.write_text(text, encoding="utf-8", newline="\n")
        cells = many(sum(cell.cell_type == "code" for cell in notebook.cells), "cell")
        click.echo(f"{'unchanged' if text == before else 'saved'} {path}: {cells}, {len(text.encode()) / 1000:.0f} kB")
