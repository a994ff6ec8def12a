import pytest
from hypothesis import settings

settings.register_profile("default", deadline=None, max_examples=25, derandomize=True)
settings.register_profile("exhaustive", deadline=None, max_examples=2000)

TOGETHER = ("tests/browser/", "notebooks/")


def pytest_configure(config):
    chosen = "exhaustive" if config.option.markexpr == "exhaustive" else "default"
    settings.load_profile(chosen)


def pytest_ignore_collect(collection_path, config):
    """Benchmarks run when they are asked for: ``pytest tests/benchmarks``."""
    if collection_path.name == "benchmarks" and not any("benchmarks" in str(arg) for arg in config.invocation_params.args):
        return True


@pytest.fixture(autouse=True)
def nothing_compiles_ahead(monkeypatch):
    """No widget of a test starts to compile in the background."""
    monkeypatch.setattr("fem_mesh.algorithms.ahead.compile_ahead", lambda: None)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Of a whole run, modules stay together; and so do all tests in a browser, which they share, and all notebooks."""
    from xdist.scheduler import LoadScopeScheduling

    class Rooms(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            return next((room for room in TOGETHER if nodeid.startswith(room)), None) or super()._split_scope(nodeid)

    return Rooms(config, log) if config.getvalue("dist") == "loadscope" else None
