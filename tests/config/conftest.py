import pytest


@pytest.fixture(autouse=True)
def _by_hydra_alone(plain_hydra: None) -> None:
    """What is tested here is how configs compose."""
