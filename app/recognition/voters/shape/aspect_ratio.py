"""Voter `aspect_ratio`: width over height of the drawing."""

from math import log2

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.shape.proportion_voter import ProportionVoter


class AspectRatio(ProportionVoter):
    """Difference of ``log2(width / height)`` of the box around the strokes.

    The paper has no logarithm; with it, twice as wide and twice as high are equally far from
    square.
    """

    name = "aspect_ratio"
    unit = "doublings of width over height"
    prior = 0.025
    within = 0.3
    between = 0.46

    def measure(self, drawing: Drawing) -> float:
        """Return 0 for a square box, > 0 for a wide one, < 0 for a high one."""
        width, height = drawing.contour.box
        return log2(width / height)
