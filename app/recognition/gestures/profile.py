"""Profiles: sets of voters with a decision rule."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from app.recognition.errors import OsgError
from app.recognition.text.wording import join_words
from app.recognition.voters.registry import MOTION_VOTERS, PAPER_VOTERS
from app.recognition.voters.voter import Voter

ProfileName = Literal["paper", "full"]


@dataclass(frozen=True)
class Profile:
    """The properties of a profile.

    Attributes
    ----------
    name
        In results and language files.
    voters
        Voters in the order of results.
    rejects
        Whether it rejects movements that are no gesture, by a limit of the language.
    repairs_keypoints
        Whether side swaps and outliers of the query are repaired first.

    """

    name: ProfileName
    voters: tuple[Voter, ...]
    rejects: bool
    repairs_keypoints: bool


PROFILES: Final[dict[str, Profile]] = {
    "paper": Profile("paper", PAPER_VOTERS, rejects=False, repairs_keypoints=False),
    "full": Profile("full", MOTION_VOTERS, rejects=True, repairs_keypoints=True),
}
"""Profiles by name. ``paper``: the seven voters of the paper, majority vote. ``full``: a few
distances of movements and hands, fused."""

DEFAULT_PROFILE: Final[ProfileName] = "full"
"""Profile of a language whose author chose none: it rejects movements that are no gesture."""


def find_profile(name: str) -> Profile:
    """Return a profile by its name.

    Raises
    ------
    OsgError
        When there is no such profile.

    """
    if name not in PROFILES:
        raise OsgError(f"no profile {name!r}; this version has {join_words([*PROFILES])}")
    return PROFILES[name]
