"""Profiles: sets of voters that decide together."""

from __future__ import annotations

from typing import Final, Literal

from app.recognition.errors import RecognitionError
from app.recognition.text.wording import listed
from app.recognition.voters import PAPER_VOTERS, Voter
from app.recognition.voters.motion import MOTION_VOTERS, MotionVoter

ProfileName = Literal["paper", "full"]

PROFILES: Final[dict[str, tuple[Voter | MotionVoter, ...]]] = {
    "paper": PAPER_VOTERS,
    "full": (*PAPER_VOTERS, *MOTION_VOTERS),
}
"""The voters of each profile. ``paper``: the seven of the paper, majority vote, no rejection.
``full``: also the movement itself, by calibrated distances."""

DEFAULT_PROFILE: Final[ProfileName] = "full"
"""Profile of a language whose author chose none: it rejects what is no gesture."""


def voters_of(profile: str) -> tuple[str, ...]:
    """Return the names of a profile's voters.

    Raises
    ------
    RecognitionError
        When there is no such profile.

    """
    if profile not in PROFILES:
        raise RecognitionError(f"no profile {profile!r}; this version has {listed([*PROFILES])}")
    return tuple(voter.name for voter in PROFILES[profile])
