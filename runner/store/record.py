"""Schema of a run's record.

Digests detect only accidental damage. `find_faults` also detects an invalid record with a valid digest.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Strict, ValidationError

_Number = float | None
_Ends = Annotated[tuple[_Number, _Number], Strict(False)]
_Entry = Annotated[tuple[str, _Ends], Strict(False)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Metric(_Part):
    unit: str
    values: list[_Number] | None = None
    median: _Number
    min: _Number
    max: _Number


class _Failure(_Part):
    reason: str
    time: _Number
    joint: str | None
    repetition: int | None


class _Caveat(_Part):
    rule: str
    text: str
    value: _Number


class _Share(_Part):
    kept: int | None
    of: int | None
    low: _Number
    high: _Number


class _Bound(_Share):
    min: _Number
    max: _Number
    reason: str


class _Spec(_Part):
    bounds: dict[str, _Bound]
    all: _Share
    history: dict[str, list[_Entry]] = {}


class _Provenance(_Part):
    date: str
    command: str
    commit: str | None
    versions: dict[str, str]
    machine: str
    seed: int
    plant_step: float
    warnings: list[str]


class _Record(_Part):
    status: Literal["ok", "failed"]
    repetitions: int
    failure: _Failure | None = None
    caveats: list[_Caveat] = []
    spec: _Spec | None = None
    metrics: dict[str, _Metric]
    timing: dict[str, _Number]
    provenance: _Provenance


def find_faults(record: Any) -> str:
    """Return a message that describes the faults of a run's record; empty if there are none."""
    try:
        found = _Record.model_validate(record)
    except ValidationError as error:
        return "; ".join(f"{'.'.join(map(str, item['loc']))}: {item['msg']}" for item in error.errors()[:3])
    return "failure: missing" if found.status == "failed" and found.failure is None else ""
