from collections.abc import Iterator

import pytest
from support import composing

_NOT_ABOUT_COMPOSING = ("test_every_option.py", "test_meanings.py", "test_options.py", "test_validation.py")


@pytest.fixture(autouse=True)
def _by_hydra_alone(request: pytest.FixtureRequest) -> Iterator[None]:
    """Most of what is tested here is how configs compose."""
    if request.path.name in _NOT_ABOUT_COMPOSING:
        yield
    else:
        with composing.plainly():
            yield
