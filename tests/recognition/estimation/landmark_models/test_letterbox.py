"""The way of an image into a model's input and back."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.onnx_session import BAR, Letterbox
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.marker_models import draw_markers

SIZES = st.tuples(st.integers(1, 4000), st.integers(1, 4000))
INPUTS = st.tuples(*(st.sampled_from([192, 320, 384, 416, 640]),) * 2)
SHARES = st.lists(st.floats(-0.5, 1.5), min_size=2, max_size=2)


def to_input(letterbox: Letterbox, points: FloatArray) -> FloatArray:
    """Map pixels of the image to pixels of the input: the inverse of `Letterbox.to_image`."""
    origin, one = letterbox.to_image(np.array([[0.0, 0.0], [1.0, 1.0]]))
    return np.asarray((points - origin) / (one - origin))


@given(SIZES, INPUTS, SHARES)
def test_there_and_back_is_where_one_was(
    image: tuple[int, int], model: tuple[int, int], share: list[float]
) -> None:
    letterbox = Letterbox.fitting(image, model)
    point: FloatArray = np.array(share) * image
    back = letterbox.to_image(to_input(letterbox, point))
    np.testing.assert_allclose(back, point, atol=1e-6 * max(image))


@given(SIZES, INPUTS)
def test_the_image_lies_in_the_input_and_touches_it(
    image: tuple[int, int], model: tuple[int, int]
) -> None:
    letterbox = Letterbox.fitting(image, model)
    low, high = to_input(letterbox, np.array([[0.0, 0.0], image]))
    assert (low >= 0).all()
    assert (high <= np.array(model) + 1e-9).all()
    assert np.isclose(high - low, model).any()


@given(SIZES, INPUTS)
def test_the_bars_on_both_sides_differ_by_a_pixel_at_most(
    image: tuple[int, int], model: tuple[int, int]
) -> None:
    letterbox = Letterbox.fitting(image, model)
    low, high = to_input(letterbox, np.array([[0.0, 0.0], image]))
    assert (np.abs((model - high) - low) <= 1 + 1e-9).all()


@given(st.tuples(st.integers(40, 1500), st.integers(40, 1500)), INPUTS)
def test_shapes_are_not_distorted_by_more_than_the_rounding_to_pixels(
    image: tuple[int, int], model: tuple[int, int]
) -> None:
    letterbox = Letterbox.fitting(image, model)
    across, down = to_input(letterbox, np.array(image, float)) - to_input(letterbox, np.zeros(2))
    scale = min(model[0] / image[0], model[1] / image[1])
    assert abs(across - scale * image[0]) <= 0.5 + 1e-9
    assert abs(down - scale * image[1]) <= 0.5 + 1e-9


@given(st.tuples(st.integers(200, 900), st.integers(200, 900)), INPUTS)
def test_a_marker_is_drawn_where_the_letterbox_says_it_is(
    size: tuple[int, int], model: tuple[int, int]
) -> None:
    width, height = size
    image = np.zeros((height, width, 3), np.uint8)
    place: FloatArray = np.array([[0.6 * width, 0.3 * height]])
    draw_markers(image, place, ((255, 0, 0),), 0.1 * min(size))
    letterbox = Letterbox.fitting(size, model)
    seen = letterbox.apply(image)
    assert seen.shape == (model[1], model[0], 3)
    weight = np.where(np.all(seen == BAR, axis=2), 0.0, seen[:, :, 0])
    row, column = np.indices(weight.shape) + 0.5
    middle = np.array([(weight * column).sum(), (weight * row).sum()]) / weight.sum()
    np.testing.assert_allclose(middle, to_input(letterbox, place)[0], atol=0.35)


def test_bars_are_grey() -> None:
    seen = Letterbox.fitting((200, 100), (640, 640)).apply(np.zeros((100, 200, 3), np.uint8))
    assert (seen[:160] == BAR).all()
    assert (seen[160:480] == 0).all()
    assert (seen[480:] == BAR).all()
