"""Tuning: what can be turned on a recogniser without touching the language."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from app.recognition.errors import OsgError
from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.poses.sequence import FloatArray
from app.recognition.text.wording import humanize, join_words

MAX_FACTOR = 100.0
"""Most that a voter's say is multiplied by: beside it, the others have none left."""

MAX_SIMPLIFICATION = 50.0
"""Pixels of 224: beyond it every drawing is a line or two."""


@dataclass(frozen=True, kw_only=True)
class Tuning:
    """How a recogniser deviates from its profile; nothing, unless told otherwise.

    Attributes
    ----------
    weights
        Factor per voter's name on what it has to say, 0: off. Voters not named keep 1.
    simplification
        Tolerance of Ramer-Douglas-Peucker, in pixels of the trajectory image, for references and
        queries alike.
    keypoints_repaired
        Whether bad keypoints of a query are repaired (`repair`); None: as the profile does,
        ``full`` does and ``paper`` does not.

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
        """Check the numbers, and freeze the weights."""
        limits = [(name, value, MAX_FACTOR) for name, value in self.weights.items()]
        for name, value, most in (
            *limits,
            ("simplification", self.simplification, MAX_SIMPLIFICATION),
        ):
            if not (math.isfinite(value) and 0 <= value <= most):
                raise OsgError(f"{name} must be a number from 0 to {most:g}, got {value!r}")
        object.__setattr__(self, "weights", MappingProxyType(dict(self.weights)))

    @property
    def words(self) -> str:
        """A clause for people that follows "recognised".

        Of a voter that keeps its weight there is nothing to say.
        """
        words = [describe_weight(*each) for each in self.weights.items() if each[1] != 1]
        if self.simplification != SIMPLIFICATION:
            words.append(describe_simplification(self.simplification))
        if self.keypoints_repaired is not None:
            words.append(describe_repair(self.keypoints_repaired))
        return join_words(words) or "as the profile does"

    def weights_of(self, voters: Sequence[str]) -> FloatArray:
        """Return the ``(V,)`` factors of the voters.

        Raises
        ------
        OsgError
            When a weight is for none of them, or all of them are off.

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


def describe_weight(voter: str, factor: float) -> str:
    """Say what a factor on a voter's weight means."""
    name = humanize(voter)
    if factor == 0:
        return f"without the voter {name}"
    return f"with {factor:g} times the weight on the voter {name}"


def describe_simplification(tolerance: float) -> str:
    """Say how coarse drawings are, by their tolerance in pixels."""
    return f"with drawings simplified by {tolerance:g} pixels"


def describe_repair(repaired: bool) -> str:
    """Say what happens to bad keypoints."""
    if repaired:
        return "with exchanged sides put right and jumps left out"
    return "with the keypoints left as the pose model saw them"
