"""Schema of the server's state."""

from __future__ import annotations

from pydantic import BaseModel, Field


class Health(BaseModel):
    """Whether the server works."""

    status: str = Field(description="ok, or models_missing: then clips cannot be extracted")
    version: str
    models: dict[str, str] = Field(description="ok, missing or damaged, per model file")
