"""Regions: geometry laws, and crops that show what the geometry says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.region import (
    REPLICATED_BORDER,
    ZERO_BORDER,
    Region,
    upright,
)
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.landmark_models.crops import to_crop

COORDINATE = st.floats(-500, 2500)
REGIONS = st.builds(
    Region,
    x=COORDINATE,
    y=COORDINATE,
    side=st.floats(2, 3000),
    rotation=st.floats(-math.pi, math.pi),
)
POINTS = st.lists(st.tuples(COORDINATE, COORDINATE), min_size=1, max_size=5).map(np.array)


def gradient(height: int, width: int) -> Image:
    """Red grows to the right and green downwards, one step a pixel."""
    image = np.zeros((height, width, 3), np.uint8)
    image[..., 0] = np.arange(width)
    image[..., 1] = np.arange(height)[:, None]
    return image


@given(REGIONS, POINTS, st.sampled_from([192, 224, 256]))
def test_mapping_to_the_crop_and_back_changes_nothing(
    region: Region, points: FloatArray, size: int
) -> None:
    back = region.to_image(to_crop(region, points, size), size)
    np.testing.assert_allclose(back, points, atol=1e-6)


@given(REGIONS)
def test_the_middle_of_the_crop_is_the_region_s_centre(region: Region) -> None:
    middle = region.to_image(np.array([[112.0, 112.0]]), 224)[0]
    np.testing.assert_allclose(middle, (region.x, region.y), atol=1e-6)


@given(REGIONS)
def test_the_crop_s_corners_span_the_region(region: Region) -> None:
    corners = region.to_image(np.array([[0.0, 0.0], [256.0, 0.0], [0.0, 256.0]]), 256)
    lengths = np.linalg.norm(corners[1:] - corners[0], axis=1)
    np.testing.assert_allclose(lengths, region.side, rtol=1e-9)
    assert np.dot(corners[1] - corners[0], corners[2] - corners[0]) == pytest.approx(
        0, abs=1e-6 * region.side**2
    )


@given(st.tuples(COORDINATE, COORDINATE), st.tuples(COORDINATE, COORDINATE))
def test_an_aligned_region_shows_the_second_point_straight_above_the_first(
    centre: tuple[float, float], top: tuple[float, float]
) -> None:
    region = Region.aligned(np.array(centre), np.array(top), 1.25)
    if region.usable:
        x, y = to_crop(region, np.array([top]), 256)[0]
        assert x == pytest.approx(128, abs=1e-6)
        assert y == pytest.approx(128 - 128 / 1.25, abs=1e-6)


@given(st.tuples(COORDINATE, COORDINATE), st.tuples(COORDINATE, COORDINATE))
def test_rotations_stay_within_half_a_turn(
    base: tuple[float, float], top: tuple[float, float]
) -> None:
    assert -math.pi <= upright(np.array(base), np.array(top)) < math.pi


def test_a_crop_of_its_own_size_is_the_image() -> None:
    image = gradient(64, 64)
    np.testing.assert_array_equal(Region.around(image).crop(image, 64, ZERO_BORDER), image)


def test_a_quarter_turn_clockwise_brings_what_was_left_to_the_top() -> None:
    image = gradient(64, 64)
    turned = Region(32, 32, 64, math.pi / 2).crop(image, 64, REPLICATED_BORDER)
    # Crop (x, y) shows image (64 - y, x); row 0 lies one step beyond the image's last column.
    np.testing.assert_array_equal(turned[1:, :, 0], np.arange(63, 0, -1)[:, None].repeat(64, 1))
    np.testing.assert_array_equal(turned[1:, :, 1], np.arange(64)[None].repeat(63, 0))


@given(REGIONS.filter(lambda region: region.side < 200), st.integers(1, 40))
def test_crop_and_map_agree_on_where_a_pixel_lies(region: Region, size: int) -> None:
    image = gradient(200, 250)
    crop = region.crop(image, size, ZERO_BORDER)
    column, row = np.meshgrid(np.arange(size), np.arange(size))
    pixels = np.stack([column, row], axis=-1).reshape(-1, 2).astype(float)
    positions = region.to_image(pixels, size)
    inside = ((positions >= 0) & (positions <= (249, 199))).all(axis=1)
    seen = crop.reshape(-1, 3)[inside, :2].astype(float)
    # Half a grey level from rounding, and 1/32 pixel from sampling.
    np.testing.assert_allclose(seen, positions[inside], atol=0.55)


def test_beyond_the_image_lies_black_or_its_edge() -> None:
    image = np.full((10, 10, 3), 200, np.uint8)
    outside = Region(-100, -100, 50)
    assert not outside.crop(image, 16, ZERO_BORDER).any()
    assert (outside.crop(image, 16, REPLICATED_BORDER) == 200).all()


def test_the_whole_image_is_letterboxed_in_the_middle() -> None:
    image = np.full((50, 100, 3), 255, np.uint8)
    crop = Region.around(image).crop(image, 100, ZERO_BORDER)
    assert not crop[:25].any()
    assert crop[26:74].all()
    assert not crop[76:].any()


@pytest.mark.parametrize("flip", [np.s_[::-1], np.s_[:, ::-1], np.s_[::2, ::3]])
def test_strides_do_not_matter(flip: tuple[slice, ...]) -> None:
    view = gradient(120, 160)[flip]
    region = Region(30, 30, 50, 0.4)
    np.testing.assert_array_equal(
        region.crop(view, 32, ZERO_BORDER),
        region.crop(np.ascontiguousarray(view), 32, ZERO_BORDER),
    )


def test_a_crop_can_go_into_a_given_buffer() -> None:
    buffer = np.empty((32, 32, 3), np.uint8)
    image = gradient(64, 64)
    Region.around(image).crop(image, 32, ZERO_BORDER, out=buffer)
    np.testing.assert_array_equal(buffer, Region.around(image).crop(image, 32, ZERO_BORDER))


@given(REGIONS, REGIONS)
def test_overlap_is_symmetric_and_a_share(one: Region, other: Region) -> None:
    assert one.overlap(other) == pytest.approx(other.overlap(one))
    assert 0 <= one.overlap(other) <= 1 + 1e-9
    assert one.overlap(one) == pytest.approx(1)


def test_a_square_shifted_by_half_its_side_shares_a_third() -> None:
    assert Region(0, 0, 10).overlap(Region(5, 0, 10)) == pytest.approx(1 / 3)


@pytest.mark.parametrize(
    "region",
    [
        Region(math.nan, 0, 10),
        Region(0, math.inf, 10),
        Region(0, 0, math.nan),
        Region(0, 0, 0.5),
        Region(0, 0, 1e9),
        Region(1e9, 0, 10),
        Region(0, 0, 10, math.nan),
    ],
)
def test_no_crop_is_made_of_nonsense(region: Region) -> None:
    assert not region.usable
