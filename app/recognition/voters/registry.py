"""Voter registry: all voters in the order of results. A new voter is a class and a line here."""

from __future__ import annotations

from typing import Final

from app.recognition.voters.hand_voters import (
    FingerDirections,
    FingertipDistances,
    HandLandmarks,
    HandVoter,
)
from app.recognition.voters.motion_voters import (
    MotionVoter,
    Path,
    Place,
    SecondOpinion,
    Tempo,
    Velocity,
    WristBend,
)
from app.recognition.voters.shape_voters import (
    AspectRatio,
    Circularity,
    FourierDescriptors,
    HuMoments,
    PathComplexity,
    ShapeVoter,
    Solidity,
    ZernikeMoments,
)

PAPER_VOTERS: Final[tuple[ShapeVoter, ...]] = (
    HuMoments(),
    ZernikeMoments(),
    FourierDescriptors(),
    AspectRatio(),
    Solidity(),
    Circularity(),
    PathComplexity(),
)
"""The paper's seven (Sec. IV-D): three primary voters, then four secondary ones."""

MOTION_VOTERS: Final[tuple[MotionVoter, ...]] = (
    Velocity(),
    Place(),
    Path(),
    WristBend(),
    Tempo(),
    SecondOpinion(),
)
"""The voters of profile ``full`` that compare movements."""

HAND_VOTERS: Final[tuple[HandVoter, ...]] = (
    HandLandmarks(),
    FingerDirections(),
    FingertipDistances(),
)
"""The voters of profile ``full`` that compare held hand shapes, in languages that have any."""

FORMER_VOTERS: Final = frozenset(
    {
        *("cloud", "stroke_direction", "which_hand", "path_length"),
        *("direction", "arm_path", "posture", "hand_attitude"),
    }
)
"""Voters of earlier versions: leaving them out changed no accuracy. Weight factors for them in
language files are ignored."""

VOTER_NAMES: Final[tuple[str, ...]] = tuple(voter.name for voter in MOTION_VOTERS)
HAND_VOTER_NAMES: Final[tuple[str, ...]] = tuple(voter.name for voter in HAND_VOTERS)
