"""Voter `solidity`: the contour's area relative to its convex hull."""

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.shape.proportion_voter import ProportionVoter


class Solidity(ProportionVoter):
    """Area of the contour over the area of its convex hull: 1 for a disc, small for a V."""

    name = "solidity"
    unit = "share of the convex hull's area"
    prior = 0.025
    within = 0.075
    between = 0.29

    def measure(self, drawing: Drawing) -> float:
        """Return the share, in (0, 1]."""
        return drawing.contour.area / drawing.contour.hull_area
