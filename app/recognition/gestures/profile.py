"""Profiles: sets of voters with a decision rule, and their tuning.

A `Tuning` holds changes to a profile that are stored with a language, such as weight factors.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from app.recognition.errors import OsgError
from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.poses.sequence import FloatArray
from app.recognition.text.wording import humanize, join_words
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


MAX_FACTOR = 100.0
"""Largest weight factor: with it, the other voters no longer matter."""

MAX_SIMPLIFICATION = 50.0
"""Largest simplification tolerance, in pixels of 224: beyond it every drawing is a line or two."""


@dataclass(frozen=True, kw_only=True)
class Tuning:
    """Changes to a recogniser's profile; none by default.

    Attributes
    ----------
    weights
        Weight factor per voter's name, 0: off. Voters not named have 1.
    simplification
        Tolerance of Ramer-Douglas-Peucker, in pixels of the trajectory image, for references and
        queries alike.
    keypoints_repaired
        Whether the landmarks of queries are repaired (`repair`); None: as in the profile; ``full``
        repairs and ``paper`` does not.

    Raises
    ------
    OsgError
        When a weight or the tolerance is no number, negative, or beyond `MAX_FACTOR` or
        `MAX_SIMPLIFICATION`.

    """

    weights: Mapping[str, float] = field(default_factory=dict)
    simplification: float = SIMPLIFICATION
    keypoints_repaired: bool | None = None

    def __post_init__(self) -> None:
        """Validate the numbers, and freeze the weights."""
        limits = [(name, value, MAX_FACTOR) for name, value in self.weights.items()]
        limits.append(("simplification", self.simplification, MAX_SIMPLIFICATION))
        for name, value, most in limits:
            if not (math.isfinite(value) and 0 <= value <= most):
                raise OsgError(f"{name} must be a number from 0 to {most:g}, got {value!r}")
        object.__setattr__(self, "weights", MappingProxyType(dict(self.weights)))

    @property
    def words(self) -> str:
        """The tuning as a clause after "recognised"; weight factors of 1 are not mentioned."""
        words = [
            f"with {factor:g} times the weight on the comparison {humanize(voter)}"
            if factor
            else f"without the comparison {humanize(voter)}"
            for voter, factor in self.weights.items()
            if factor != 1
        ]
        if self.simplification != SIMPLIFICATION:
            words.append(f"with drawings simplified by {self.simplification:g} pixels")
        if self.keypoints_repaired is not None:
            words.append(describe_repair(self.keypoints_repaired))
        return join_words(words) or "as the profile does"

    def weights_of(self, voters: Sequence[str]) -> FloatArray:
        """Return the voters' weight factors, ``(V,)``.

        Raises
        ------
        OsgError
            When a factor is for another voter, or all of them are 0.

        """
        unknown = sorted(set(self.weights) - set(voters))
        if unknown:
            raise OsgError(
                f"no voter {unknown[0]!r} to weigh; this profile has {', '.join(voters)}"
            )
        factors = np.array([self.weights.get(voter, 1.0) for voter in voters])
        if not factors.any():
            raise OsgError("all voters are off: leave at least one a weight above 0")
        return factors


AS_THE_PROFILE = Tuning()


def describe_repair(repaired: bool) -> str:
    """Return in words whether keypoints are repaired."""
    if repaired:
        return "with exchanged sides put right and jumps left out"
    return "with the keypoints left as the pose model saw them"
