"""The outline follows the outer edge of the strokes, gaps closed."""

import cv2
import numpy as np
import pytest

from app.recognition.features.contour import BinaryImage, Contour
from app.recognition.features.trajectory_image import STROKE_WIDTH


def blank() -> BinaryImage:
    return np.zeros((224, 224), dtype=np.uint8)


def ring(missing: float) -> BinaryImage:
    """Draw a circle of radius 80 that lacks `missing` pixels of its circumference."""
    image = blank()
    degrees = np.degrees(missing / 80)
    cv2.ellipse(image, (112, 112), (80, 80), 0, degrees, 360, 255, STROKE_WIDTH)
    return image


def test_the_area_of_a_filled_square() -> None:
    image = blank()
    image[50:151, 60:161] = 255
    outline = Contour.of(image)
    assert outline.area == pytest.approx(100 * 100, rel=0.01)
    assert outline.perimeter == pytest.approx(400, rel=0.01)
    assert outline.box == (101, 101)
    assert outline.hull_area == pytest.approx(outline.area, rel=0.01)


def test_an_almost_closed_circle_has_the_area_of_a_closed_one() -> None:
    closed = Contour.of(ring(missing=0)).area
    assert Contour.of(ring(missing=20)).area == pytest.approx(closed, rel=0.02)
    assert Contour.of(ring(missing=60)).area < closed / 4


def test_contours_come_from_left_to_right() -> None:
    image = blank()
    for centre in ((180, 40), (40, 180), (110, 100)):
        cv2.circle(image, centre, 15, 255, -1)
    middles = [contour[:, 0].mean() for contour in Contour.of(image).contours]
    assert middles == pytest.approx([40, 110, 180], abs=1)


def test_what_lies_inside_a_closed_stroke_is_not_outline() -> None:
    image = ring(missing=0)
    cv2.circle(image, (112, 112), 10, 255, -1)
    assert len(Contour.of(image).contours) == 1


def test_a_single_pixel_has_an_outline_without_zero_measures() -> None:
    image = blank()
    image[100, 100] = 255
    outline = Contour.of(image)
    assert outline.area == outline.perimeter == outline.hull_area == 1.0
    assert outline.box == (1, 1)


@pytest.mark.parametrize("shift", [-29, 0, 29])
def test_a_figure_at_the_edge_of_the_image_has_the_same_outline(shift: int) -> None:
    square = blank()
    square[32:192, 30:33] = square[32:192, 191:194] = 255
    square[32:35, 30:194] = square[189:192, 30:194] = 255
    here, there = Contour.of(square), Contour.of(np.roll(square, shift, axis=1))
    np.testing.assert_array_equal(there.points, here.points + (shift, 0))
    assert there.area == here.area
