"""The four proportions of figures whose values are known."""

import cv2
import numpy as np
import pytest
from hypothesis import given

from app.recognition.features.trajectory_image import Drawing
from app.recognition.voters.shape_voters import AspectRatio, Circularity, PathComplexity, Solidity
from tests.recognition.strategies import Shape, strokes
from tests.recognition.voters.figures import CIRCLE, FIGURES, drawing_of

PROPORTIONS = (AspectRatio(), Solidity(), Circularity(), PathComplexity())


def rectangle(width: int, height: int) -> Drawing:
    image = np.zeros((224, 224), dtype=np.uint8)
    cv2.rectangle(image, (30, 40), (30 + width - 1, 40 + height - 1), 255, -1)
    return Drawing(image)


@pytest.mark.parametrize(
    ("width", "height", "doublings"), [(100, 100, 0), (160, 40, 2), (40, 160, -2)]
)
def test_aspect_ratio_counts_doublings(width: int, height: int, doublings: int) -> None:
    assert AspectRatio().describe(rectangle(width, height)) == pytest.approx([doublings])


def test_a_disc_is_solid_and_circular_and_simple() -> None:
    disc = drawing_of(CIRCLE)
    assert Solidity().describe(disc)[0] == pytest.approx(1.0, abs=0.03)
    assert Circularity().describe(disc)[0] == pytest.approx(0.9, abs=0.05)  # pixels are not round
    assert PathComplexity().describe(disc)[0] == pytest.approx(np.pi / 4, abs=0.06)


def test_a_square_has_the_circularity_of_a_square() -> None:
    square = rectangle(120, 120)
    assert Circularity().describe(square)[0] == pytest.approx(np.pi / 4, abs=0.01)
    assert PathComplexity().describe(square)[0] == pytest.approx(1.0, abs=0.01)


def test_a_wedge_is_hollow_and_a_disc_is_not() -> None:
    assert Solidity().describe(drawing_of(FIGURES["wedge"]))[0] < 0.25


def test_a_zigzag_is_more_complex_than_a_wedge() -> None:
    share = np.linspace(0, 1, 101)
    zigzag = np.stack([share, np.abs((share * 8) % 2 - 1)], axis=1)
    wedge = drawing_of(FIGURES["wedge"])
    assert PathComplexity().describe(drawing_of(zigzag)) > PathComplexity().describe(wedge)


@given(strokes())
def test_shares_are_shares(stroke: Shape) -> None:
    drawing = drawing_of(stroke(np.linspace(0, 1, 60)))
    for voter in (Solidity(), Circularity()):
        assert 0 < voter.describe(drawing)[0] <= 1
    assert PathComplexity().describe(drawing)[0] > 0


@pytest.mark.parametrize("voter", PROPORTIONS, ids=lambda voter: voter.name)
def test_a_proportion_is_compared_by_its_difference(voter: Solidity) -> None:
    assert voter.length(1) == 1
    np.testing.assert_allclose(
        voter.distances(np.array([0.5]), np.array([[0.5], [0.75], [0.25]])), [0, 0.25, 0.25]
    )
