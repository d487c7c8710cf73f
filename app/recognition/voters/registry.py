"""Voter registry: all voters in the order of results. A new voter is a module and a line here."""

from __future__ import annotations

from typing import Final

from app.recognition.voters.hand.finger_directions import FingerDirections
from app.recognition.voters.hand.fingertip_distances import FingertipDistances
from app.recognition.voters.hand.hand_landmarks import HandLandmarks
from app.recognition.voters.hand.hand_voter import HandVoter
from app.recognition.voters.motion.motion_voter import MotionVoter
from app.recognition.voters.motion.path import Path
from app.recognition.voters.motion.place import Place
from app.recognition.voters.motion.tempo import Tempo
from app.recognition.voters.motion.velocity import Velocity
from app.recognition.voters.motion.wrist_bend import WristBend
from app.recognition.voters.shape.aspect_ratio import AspectRatio
from app.recognition.voters.shape.circularity import Circularity
from app.recognition.voters.shape.fourier import FourierDescriptors
from app.recognition.voters.shape.hu import HuMoments
from app.recognition.voters.shape.path_complexity import PathComplexity
from app.recognition.voters.shape.shape_voter import ShapeVoter
from app.recognition.voters.shape.solidity import Solidity
from app.recognition.voters.shape.zernike import ZernikeMoments

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
