"""Hu's moments: independent of a figure's place, size and rotation."""

import cv2
import numpy as np
import pytest

from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import FLOOR, HuMoments
from tests.recognition.voters.figures import CIRCLE, FIGURES, drawing_of, turned

BETWEEN_FIGURES = 1.0
"""Decades: drawings of one figure lie closer, those of different figures farther apart."""


def described(points: FloatArray) -> FloatArray:
    return HuMoments().describe(drawing_of(points))


def test_seven_invariants() -> None:
    assert described(CIRCLE).shape == (HuMoments().length(1),) == (7,)


def test_the_first_invariant_of_a_known_figure() -> None:
    drawing = drawing_of(CIRCLE)
    area = np.count_nonzero(drawing.image)
    rows, columns = np.nonzero(drawing.image)
    spread = np.var(rows) + np.var(columns)  # (mu20 + mu02) / mu00 = eta * mu00
    first = spread / area
    assert described(CIRCLE)[0] == pytest.approx(np.log10(1 + first / FLOOR), rel=1e-6)


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize("degrees", [90, 180, 270])
def test_turning_a_figure_by_right_angles_changes_little(name: str, degrees: float) -> None:
    upright, lying = described(FIGURES[name]), described(turned(FIGURES[name], degrees))
    assert HuMoments().distances(upright, lying[None])[0] < BETWEEN_FIGURES


def test_different_figures_are_told_apart() -> None:
    descriptors = [described(points) for points in FIGURES.values()]
    for index, descriptor in enumerate(descriptors):
        others = np.stack(descriptors[:index] + descriptors[index + 1 :])
        assert (HuMoments().distances(descriptor, others) > BETWEEN_FIGURES).any()


def test_it_agrees_with_opencv_up_to_the_scale() -> None:
    image = drawing_of(CIRCLE).image
    plain = np.asarray(cv2.HuMoments(cv2.moments(image, binaryImage=True))).ravel()
    np.testing.assert_array_equal(np.sign(described(CIRCLE)), np.sign(plain))
