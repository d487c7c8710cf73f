"""Fourier descriptors: where an outline lies, its size and where it starts do not matter."""

import numpy as np
import pytest
from hypothesis import given

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import FourierDescriptors
from tests.recognition.strategies import Shape, strokes
from tests.recognition.voters.figures import CIRCLE, FIGURES, SIX, drawing_of, turned

VOTER = FourierDescriptors()


def described(points: FloatArray) -> FloatArray:
    return VOTER.describe(drawing_of(points))


def distance(one: FloatArray, other: FloatArray) -> float:
    return float(VOTER.distances(one, other[None])[0])


def shifted(descriptor: FloatArray, turns: float) -> FloatArray:
    """Describe the same outline from a start point `turns` of the way around."""
    half = len(descriptor) // 2
    harmonics = np.concatenate([np.arange(1, half // 2 + 1), np.arange(-(half // 2), 0)])
    spectrum = descriptor[:half] + 1j * descriptor[half:]
    spectrum = spectrum * np.exp(2j * np.pi * turns * harmonics)
    return np.concatenate([spectrum.real, spectrum.imag])


def test_a_descriptor_is_ten_harmonics_on_either_side_of_norm_one() -> None:
    descriptor = described(SIX)
    assert descriptor.shape == (VOTER.length(1),) == (40,)
    assert np.linalg.norm(descriptor) == pytest.approx(1.0)


def test_a_circle_is_its_first_harmonic() -> None:
    descriptor = described(CIRCLE)
    half = len(descriptor) // 2
    magnitudes = np.hypot(descriptor[:half], descriptor[half:])
    # OpenCV walks outer contours counter-clockwise as seen, with y down harmonic -1.
    assert max(magnitudes[0], magnitudes[-1]) > 0.99


@given(strokes())
def test_the_start_point_does_not_matter(stroke: Shape) -> None:
    descriptor = described(stroke(np.linspace(0, 1, 60)))
    for step in (1, 37, 64):
        assert distance(descriptor, shifted(descriptor, step / 128)) < 1e-6
    # Between two start points tried, at most half a step is missed.
    assert distance(descriptor, shifted(descriptor, 0.5 / 128)) < 0.25


@given(strokes(), strokes())
def test_distance_is_symmetric_zero_for_the_same_and_at_most_two(one: Shape, other: Shape) -> None:
    first, second = (described(shape(np.linspace(0, 1, 60))) for shape in (one, other))
    assert distance(first, first) == 0.0
    assert distance(first, second) == pytest.approx(distance(second, first), abs=1e-9)
    assert distance(first, second) <= 2.0


def test_the_distance_is_the_least_over_all_start_points() -> None:
    six, square = described(SIX), described(FIGURES["square"])
    tried = [np.linalg.norm(six - shifted(square, step / 128)) for step in range(128)]
    assert distance(six, square) == pytest.approx(min(tried), abs=1e-9)


def test_a_six_is_no_nine() -> None:
    six, nine = described(SIX), described(turned(SIX, 180))
    assert distance(six, nine) > 0.2


def test_all_references_are_compared_at_once() -> None:
    references = np.stack([described(points) for points in FIGURES.values()])
    together = VOTER.distances(references[1], references)
    one_by_one = [distance(references[1], reference) for reference in references]
    np.testing.assert_allclose(together, one_by_one, atol=1e-12)
    assert together.argmin() == 1


def test_two_figures_are_walked_from_left_to_right() -> None:
    nowhere = np.full((1, 2), np.nan)
    pair = np.concatenate([CIRCLE, nowhere, FIGURES["square"] + (1.5, 0)])
    swapped = np.concatenate([FIGURES["square"] + (1.5, 0), nowhere, CIRCLE])
    assert distance(described(pair), described(swapped)) < 0.05


def test_a_single_pixel_has_a_descriptor() -> None:
    image = np.zeros((224, 224), dtype=np.uint8)
    image[10, 10] = 255
    np.testing.assert_array_equal(VOTER.describe(Drawing(image)), np.zeros(40))
