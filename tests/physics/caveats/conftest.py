import pytest

from runner.sweeps.job import run


@pytest.fixture(scope="session")
def make_run(tmp_path_factory):
    """Stored runs, in one outputs folder."""
    outputs = tmp_path_factory.mktemp("caveats")
    return lambda *overrides: run(*overrides, f"outputs={outputs}")
