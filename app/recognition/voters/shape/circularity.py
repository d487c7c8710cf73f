"""Voter `circularity`: how close the contour is to a circle."""

from math import pi

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.shape.proportion_voter import ProportionVoter


class Circularity(ProportionVoter):
    """``4 pi a / p^2`` of the contour's area a and perimeter p: 1 for a disc, 0.79 for a square."""

    name = "circularity"
    unit = "share of the area of a disc with the same perimeter"
    prior = 0.025
    within = 0.055
    between = 0.17

    def measure(self, drawing: Drawing) -> float:
        """Return the circularity, in (0, 1]."""
        return 4 * pi * drawing.contour.area / drawing.contour.perimeter**2
