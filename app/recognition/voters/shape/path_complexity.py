"""Voter `path_complexity`: the length of the contour relative to its bounding box."""

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.shape.proportion_voter import ProportionVoter


class PathComplexity(ProportionVoter):
    """Length of the contour over the perimeter of its bounding box: high for a zigzag."""

    name = "path_complexity"
    unit = "perimeters of the bounding box"
    prior = 0.025
    within = 0.1
    between = 0.23

    def measure(self, drawing: Drawing) -> float:
        """Return the complexity, about 0.8 for a circle, 1 for a square and more for a zigzag."""
        return drawing.contour.perimeter / (2 * sum(drawing.contour.box))
