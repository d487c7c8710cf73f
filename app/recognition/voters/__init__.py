"""The voters: each compares a query with every reference from its own point of view."""

from app.recognition.voters.base import Voter, describe
from app.recognition.voters.fourier import FourierDescriptors
from app.recognition.voters.hu import HuMoments
from app.recognition.voters.proportions import (
    AspectRatio,
    Circularity,
    PathComplexity,
    Solidity,
)
from app.recognition.voters.zernike import ZernikeMoments

PAPER_VOTERS: tuple[Voter, ...] = (
    HuMoments(),
    ZernikeMoments(),
    FourierDescriptors(),
    AspectRatio(),
    Solidity(),
    Circularity(),
    PathComplexity(),
)
"""The paper's seven (Sec. IV-D): three primary voters, then four secondary ones."""

__all__ = [
    "PAPER_VOTERS",
    "AspectRatio",
    "Circularity",
    "FourierDescriptors",
    "HuMoments",
    "PathComplexity",
    "Solidity",
    "Voter",
    "ZernikeMoments",
    "describe",
]
