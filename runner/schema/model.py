"""Base class of every config model."""

from pydantic import BaseModel, ConfigDict


class StrictModel(BaseModel):
    """Base of every config model: no unknown key, no silent conversion, no NaN or infinity, unchangeable."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)
