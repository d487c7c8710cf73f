"""Where a point of the image lies in a region's crop."""

import numpy as np

from app.recognition.estimation.landmark_models.region import Region
from app.recognition.poses.sequence import FloatArray


def to_crop(region: Region, points: FloatArray, size: int) -> FloatArray:
    """Map ``(N, 2)`` pixels of the image to pixels of the `size` x `size` crop."""
    matrix = region.matrix(size)
    return np.asarray(np.linalg.solve(matrix[:, :2], (points - matrix[:, 2]).T).T)
