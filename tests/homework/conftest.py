import pytest
from classroom import Class


@pytest.fixture
def course(tmp_path):
    return Class(tmp_path)
