"""The same grading on a Dask cluster: a scheduler and a worker here, each a process of its own."""

import pytest

from fem_mesh.course.homework import grade as grading

pytest.importorskip("distributed")


def test_a_cluster_gives_the_same_marks(course):
    from distributed import LocalCluster

    course.submit("ada")
    course.submit("bob", course.notebook(orient="import os; os._exit(1)"))
    course.submit("cy", b"no notebook")
    with LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=None) as cluster:
        result = course.grade("--executor", cluster.scheduler_address)
    assert "3 submissions" in result.output
    assert course.scores() == {"ada": [2, 3, None], "bob": [0, 0, None], "cy": [0, 0, None]}


def test_a_scheduler_that_does_not_answer_is_named(course, monkeypatch):
    monkeypatch.setattr(grading, "ANSWERING", 1.0)
    course.submit("ada")
    result = course.grade("--executor", "tcp://127.0.0.1:9")
    assert result.exit_code == 1
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in result.output
