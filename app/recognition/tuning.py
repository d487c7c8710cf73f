"""Tuning: what can be turned on a recogniser without touching the language."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from app.recognition.errors import RecognitionError
from app.recognition.poses import FloatArray
from app.recognition.trajectory_image import SIMPLIFICATION


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
    RecognitionError
        When a weight or the tolerance is negative or no number.

    """

    weights: Mapping[str, float] = field(default_factory=dict)
    simplification: float = SIMPLIFICATION
    keypoints_repaired: bool | None = None

    def __post_init__(self) -> None:
        """Check the numbers, and freeze the weights."""
        for name, value in (*self.weights.items(), ("simplification", self.simplification)):
            if not (math.isfinite(value) and value >= 0):
                raise RecognitionError(f"{name} must be a number from 0 up, got {value!r}")
        object.__setattr__(self, "weights", MappingProxyType(dict(self.weights)))

    def weights_of(self, voters: Sequence[str]) -> FloatArray:
        """Return the ``(V,)`` factors of the voters.

        Raises
        ------
        RecognitionError
            When a weight is for none of them, or all of them are off.

        """
        unknown = sorted(set(self.weights) - set(voters))
        if unknown:
            raise RecognitionError(
                f"no voter {unknown[0]!r} to weigh; this profile has {', '.join(voters)}"
            )
        factors = np.array([self.weights.get(voter, 1.0) for voter in voters])
        if not factors.any():
            raise RecognitionError("all voters are off: leave at least one a weight above 0")
        return factors


AS_THE_PROFILE = Tuning()
