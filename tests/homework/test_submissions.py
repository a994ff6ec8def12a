"""Whose notebook is where: nobody is taken for somebody else, and nobody is passed over without a word."""

import pytest
from classroom import call

from fem_mesh.course.homework.submissions import find
from fem_mesh.course.notebooks import NotebookError


def put(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("{}")


def test_students_are_named_by_their_files_and_folders(tmp_path):
    put(tmp_path, "Ada.ipynb", "ada/hw.ipynb", "cy/x/hw.ipynb", "cy/x/other.ipynb", "b" * 240 + "/hw.ipynb", ".git/hw.ipynb")
    found, aside = find(tmp_path, "hw.ipynb")
    assert [submission.student for submission in found] == ["Ada", "ada", "b" * 240, "cy"]
    assert [submission.trouble for submission in found] == [""] * 4
    assert len(found[2].file_name) < 60
    assert len({submission.file_name.lower() for submission in found}) == 4
    assert aside == []
    (tmp_path / "empty").mkdir()
    with pytest.raises(NotebookError, match=r"a student's is ada.ipynb, or ada/hw.ipynb"):
        find(tmp_path / "empty", "hw.ipynb")


def test_names_that_make_the_same_file_name_keep_pages_of_their_own(tmp_path):
    put(tmp_path, "a\\b.ipynb", "a_b.ipynb")
    found, _ = find(tmp_path, "hw.ipynb")
    assert [submission.student for submission in found] == ["a\\b", "a_b"]
    assert len({submission.file_name for submission in found}) == 2


def test_a_file_and_a_folder_of_one_student_are_one_row(tmp_path):
    put(tmp_path, "two.ipynb", "two/hw.ipynb")
    (found,), _ = find(tmp_path, "hw.ipynb")
    assert (found.student, found.trouble) == ("two", "both two and two.ipynb are here: which one counts?")


def test_what_is_left_aside_is_told(tmp_path):
    put(tmp_path, "ada.ipynb", "bob.zip", "carl.ipynb.txt", "two/a/hw.ipynb", "two/b/hw.ipynb", "x\x1b]0;y\x07\u202e.ipynb")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "elsewhere")
    found, aside = find(tmp_path, "hw.ipynb")
    told = {submission.student: submission.trouble for submission in found}
    assert told == {
        "ada": "",
        "elsewhere": "the folder elsewhere holds no notebook",
        "link": "this is a link or a device, but no file",
        "two": "the folder two holds 2 notebooks, and 2 of them called hw.ipynb",
        "x?]0;y??": "",
    }
    assert aside == ["bob.zip", "carl.ipynb.txt"]


def test_the_graders_own_files_are_nobodys(course, monkeypatch):
    course.submit("ada", b"no notebook")
    monkeypatch.chdir(course.submissions)
    for _ in range(2):
        result = call("homework", "grade", course.source, ".", "--force", "--feedback", "out")
        assert "1 submission: 0 graded, 1 not" in result.output
        assert "left aside" not in result.output
