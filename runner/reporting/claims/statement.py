"""Published statements as data: qualitative claims that findings on many runs evaluate."""

from pathlib import Path

from runner.base.data_file import read_data
from runner.base.paths import studies_dir, studies_with
from runner.schema.model import StrictModel

_FILE = "statements.yaml"


class PublishedStatement(StrictModel):
    """One statement, which findings on many runs judge.

    Attributes:
        name: A short name, by which its judgement is found.
        statement: What the source says.
        place: Where.
        reason: What is to be said of the verdict; inline mathematics between dollar signs.
    """

    name: str
    statement: str
    place: str
    reason: str = ""


def studies_with_statements() -> list[str]:
    """Return the names of the studies that have statements, sorted."""
    return studies_with(_FILE)


def load_statements(study: str | Path) -> list[PublishedStatement]:
    """Return the statements of a study in order.

    Args:
        study: One of ours by its name, such as "meca500", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file does not fit; names the file, the entries and keys.
    """
    return read_data(studies_dir() / study / _FILE, list[PublishedStatement])
