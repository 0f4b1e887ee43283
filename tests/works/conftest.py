import pytest


@pytest.fixture(scope="module", params=["thin", pytest.param("whole", marks=pytest.mark.slow)])
def thin(request: pytest.FixtureRequest) -> bool:
    """Whether the plan of a work is made thin, as `make test` has it, or run as a whole, as `make test-slow` has it."""
    return request.param == "thin"
