"""Route of the server's state: version and state of the model files."""

from __future__ import annotations

from fastapi import APIRouter

from app import __version__
from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.recognition.models.storage import installed_models


class Health(View):
    """Whether the server works."""

    status: str
    """ok, or models_missing: then clips cannot be extracted."""
    version: str
    models: dict[str, str]
    """ok, missing or damaged, per model file."""


router = APIRouter(tags=["health"])


@router.get("/healthz", responses=problem_responses())
def get_health() -> Health:
    """Return the version and the state of the model files."""
    models: dict[str, str] = {model.name: model.state for model in installed_models()}
    status = "ok" if all(state == "ok" for state in models.values()) else "models_missing"
    return Health(status=status, version=__version__, models=models)
