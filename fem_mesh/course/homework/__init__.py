"""Homework: students' versions of a notebook, and marks for what comes back.

``cells`` knows what a cell is for, ``release`` takes the solutions out, ``merge`` puts a student's answers into the
instructor's notebook, ``room`` and ``sandbox`` make the place where that runs, ``drive`` runs it, ``grade_one`` judges
one submission, ``grade`` a class.
"""
