"""Route of a language's settings: its profile and voters' weights beside the defaults."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.routes.asked_revisions import CurrentRevision
from app.api.services.running_studio import computed_briefly
from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.gestures.profile import (
    DEFAULT_PROFILE,
    MAX_SIMPLIFICATION,
    PROFILES,
    ProfileName,
)
from app.recognition.language.file_schema import TuningEntry, tuning_to_entry

router = APIRouter(prefix="/languages", tags=["languages"])


class ProfileView(View):
    """A profile that a language can choose."""

    name: ProfileName
    rejects: bool
    """Whether it rejects movements that are no gesture."""
    repairs_keypoints: bool
    """Whether bad keypoints are repaired first."""
    voters: list[str]


class SettingsView(View):
    """How a language is recognised, and what it would be by default."""

    profile: ProfileName
    default_profile: ProfileName
    profiles: list[ProfileView]
    tuning: TuningEntry | None
    """What differs from the profile; null: nothing."""
    simplification: float
    """Default tolerance of drawings, pixels of 224."""
    most_simplification: float
    weights: dict[str, float]
    """Each voter's normalised weight in this language, with its weight factor; empty without
    gestures."""


@router.get("/{language_id}/settings", responses=problem_responses(404))
@computed_briefly
def get_settings(asked: CurrentRevision) -> SettingsView:
    """Return profile and tuning of a language beside the defaults; `PATCH` changes them."""
    language = asked.language
    weights = dict(asked.studio.recognizer(asked.state).vote.weights) if language.gestures else {}
    return SettingsView(
        profile=language.profile,
        default_profile=DEFAULT_PROFILE,
        profiles=[
            ProfileView(**(vars(each) | {"voters": [voter.name for voter in each.voters]}))
            for each in PROFILES.values()
        ],
        tuning=tuning_to_entry(language.tuning),
        simplification=SIMPLIFICATION,
        most_simplification=MAX_SIMPLIFICATION,
        weights=weights,
    )
