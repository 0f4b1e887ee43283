import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all processes of this test session see."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="module", params=["thin", pytest.param("whole", marks=pytest.mark.slow)])
def thin(request: pytest.FixtureRequest) -> bool:
    """Whether the plan of a work is made thin, as `make test` has it, or run as a whole, as `make test-slow` has it."""
    return request.param == "thin"
