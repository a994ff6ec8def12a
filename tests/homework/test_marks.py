"""The table of marks: what an instructor types into it is kept and added up, and nothing of it is lost without a word."""

import csv

import pytest

from fem_mesh.check import cases_of, judge, run
from fem_mesh.course.homework.cells import Call, Task
from fem_mesh.course.homework.feedback import page
from fem_mesh.course.homework.marks import Typed, read_typed, typed_of, write_marks
from fem_mesh.course.homework.results import BY_HAND, Marked, Result, nothing, with_points
from fem_mesh.course.notebooks import NotebookError

TASKS = [
    Task("check-orient", "Which side", 2, 4, (Call("orient", "fm.check.orient(orient)"),)),
    Task("explain", "Explain", 2, 6, ()),
]
STUDENTS = ["ada", "bob", "=dee()"]


def result(student, score=2):
    return Result(
        student, [Marked("check-orient", "Which side", 2, score, "said"), Marked("explain", "Explain", 2, None, BY_HAND)]
    )


class Table:
    """A table as ``grade`` writes it, and its copy."""

    def __init__(self, folder):
        self.path, self.written = folder / "grades.csv", folder / "written-grades.csv"

    def read(self, students=STUDENTS, homework="hw"):
        return read_typed(self.path, homework, TASKS, students, self.written)

    def write(self, results=None, typed=None):
        typed = typed or {}
        results = results or [result(student) for student in STUDENTS]
        results = [with_points(each, typed_of(each, typed).points) for each in results]
        write_marks(self.path, "hw", TASKS, results, typed=typed)
        self.written.write_bytes(self.path.read_bytes())

    def rows(self):
        with self.path.open(newline="", encoding="utf-8-sig") as file:
            return {row["student_id"]: row for row in csv.DictReader(file)}

    def type(self, student, delimiter=",", **places):
        rows = self.rows()
        rows[student] |= places
        with self.path.open("w", newline="", encoding="utf-8-sig") as file:
            table = csv.DictWriter(
                file, list(dict.fromkeys(name for row in rows.values() for name in row)), delimiter=delimiter
            )
            table.writeheader()
            table.writerows(rows.values())


@pytest.fixture
def table(tmp_path):
    made = Table(tmp_path)
    assert made.read() == {}
    made.write()
    return made


@pytest.mark.parametrize(("delimiter", "told"), [(",", "1.5"), (";", "1,5"), ("\t", " 1.5 ")])
def test_points_that_are_typed_are_kept_and_added_up(table, delimiter, told):
    table.type("ada", delimiter, explain=told, score="10", note="late, but ill")
    typed = table.read()
    assert typed["ada"] == Typed({"explain": 1.5}, 0, {"note": "late, but ill"})
    table.write(typed=typed)
    row = table.rows()["ada"]
    assert [row[name] for name in ("raw_score", "score", "max_score", "explain", "note")] == [
        "3.5",
        "3.5",
        "4",
        "1.5",
        "late, but ill",
    ]
    assert table.rows()["bob"]["score"] == "2"
    table.write([result("ada", 0), result("bob"), result("=dee()")], typed=table.read())  # handed in once more
    assert table.rows()["ada"]["score"] == "1.5"


def test_a_penalty_is_taken_off_and_a_bonus_added(table):
    table.type("ada", late_submission_penalty="0.5")
    table.type("bob", late_submission_penalty="-1")
    table.type("'=dee()", late_submission_penalty="9", explain="1")
    for _ in range(2):
        table.write(typed=table.read())
    rows = table.rows()
    assert [(row["raw_score"], row["score"]) for row in rows.values()] == [("2", "1.5"), ("2", "3"), ("3", "0")]
    assert rows["bob"]["late_submission_penalty"] == "-1"


@pytest.mark.parametrize(
    ("places", "message"),
    [
        ({"explain": "3"}, "grades.csv, ada: explain must be a number from 0 to 2, not '3'"),
        ({"explain": "-1"}, "explain must be a number from 0 to 2"),
        ({"explain": "nan"}, "explain must be a number from 0 to 2"),
        ({"explain": "good"}, "explain must be a number from 0 to 2, not 'good'"),
        ({"late_submission_penalty": "two"}, "late_submission_penalty must be a number, not 'two'"),
        ({"check-orient": "1"}, r"check-orient was 2, and is 1, but what checks found is written anew each time: type"),
        ({"check-orient": ""}, r"check-orient was 2, and is empty"),
        ({"assignment": "hw2"}, r"grades.csv is the table of hw2, not of hw: name another table with --csv"),
    ],
)
def test_what_would_be_lost_is_refused(table, places, message):
    table.type("ada", **places)
    with pytest.raises(NotebookError, match=message):
        table.read()


def test_points_of_one_who_is_not_here_are_not_thrown_away(table):
    assert table.read(["ada", "=dee()"]).keys() == {"ada", "bob", "'=dee()"}  # nothing was typed for bob
    table.type("bob", explain="1")
    with pytest.raises(NotebookError, match="holds what you typed for bob, of whom there is nothing here"):
        table.read(["ada", "=dee()"])


def test_a_spreadsheet_may_write_numbers_and_times_in_its_own_way(table):
    table.type("ada", **{"check-orient": "2,0", "timestamp": "1.2.2026", "explain": "2"})
    assert table.read()["ada"].points == {"explain": 2}


def test_what_is_no_table_of_marks_is_not_written_over(table):
    for content in (b"a,b\n1,2\n", b"student_id,assignment\n\xff,hw\n"):
        table.path.write_bytes(content)
        with pytest.raises(NotebookError, match="no table"):
            table.read()
    table.path.write_text("")
    assert table.read() == {}


def test_the_page_shows_what_was_given_by_hand():
    given = with_points(result("ada"), {"explain": 1})
    text = page(given, "hw", 0.5)
    assert "2.5 of 4 points, 0.5 points taken off by hand" in text
    assert "1 of 2 points: by hand" in text
    assert BY_HAND not in text
    assert "4 of 4 points, 1 point added by hand" in page(given, "hw", -1)
    text = page(result("ada"), "hw")
    assert "2 of 2 points, and 2 more that are given by hand" in text
    assert "2 points: to be marked by hand" in text


def test_a_page_says_nothing_twice():
    tasks = [Marked("a", "Task 1: `flip` (1 point)", 1, 0, "not written yet"), Marked("b", "B", 1, None, "not answered")]
    text = page(Result("bob", tasks), "hw")
    assert "<h2>Task 1: <code>flip</code></h2>" in text
    assert "0 of 1 point: not written yet" in text
    assert text.count("not written yet") == text.count("not answered") == 1
    assert "stands out" not in text
    free = [Marked("a", "A", 0, 0, "a: said", [{"check": "a", "right": right, "message": "x"}]) for right in (True, False)]
    assert page(Result("bob", free), "hw").count("0 of 0 points: not yet right") == 1
    text = page(nothing("cy", TASKS, "the file is empty"), "hw")
    assert text.count("the file is empty") == 1
    assert "0 of 2 points: not graded" in text


def test_two_panels_keep_a_size_that_can_be_read_on_a_telephone():
    told = judge("lawson", run("lawson", lambda points, triangles: iter([]), cases_of("lawson")), cases_of("lawson")).as_json()
    assert '<figure><img class="wide" alt="' in page(Result("ada", [Marked("a", "A", 2, 0, "said", [told])]), "hw")
