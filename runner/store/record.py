"""What a run's record must hold; of one without digests nothing else says that it is whole."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Metric(_Part):
    unit: str
    values: list[float | None]
    median: float | None
    min: float | None
    max: float | None


class _Failure(_Part):
    reason: str
    time: float | None
    joint: str | None
    repetition: int | None


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
    metrics: dict[str, _Metric]
    timing: dict[str, float | None]
    provenance: _Provenance


def find_faults(record: Any) -> str:
    """Return what is wrong with a run's record, in words; empty where nothing is."""
    try:
        found = _Record.model_validate(record)
    except ValidationError as error:
        return "; ".join(f"{'.'.join(map(str, item['loc']))}: {item['msg']}" for item in error.errors()[:3])
    return "failure: missing" if found.status == "failed" and found.failure is None else ""
