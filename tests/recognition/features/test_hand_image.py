"""Hand images: held hands as white lines that fill the picture."""

import numpy as np

from app.recognition.features.trajectory_image import MARGIN, SIZE, draw_hands, place_hands
from app.recognition.poses.frame import HandShape
from tests.recognition.held_takes import FIST, FLAT
from tests.recognition.parametric_hand import hand_xy

FLAT_HAND = HandShape.of_frames("right", hand_xy(FLAT)[None])


def test_a_hand_fills_the_picture_within_the_margin() -> None:
    image = draw_hands([FLAT_HAND])
    assert image.shape == (SIZE, SIZE)
    assert set(np.unique(image)) == {0, 255}
    rows, columns = np.nonzero(image)
    assert max(np.ptp(rows), np.ptp(columns)) >= SIZE - 2 * MARGIN - 1
    assert rows.min() >= MARGIN // 2 <= columns.min()


def test_another_shape_is_another_picture_and_its_mirror_image_is_mirrored() -> None:
    image = draw_hands([FLAT_HAND])
    assert (image != draw_hands([HandShape.of_frames("right", hand_xy(FIST)[None])])).any()
    assert (draw_hands([FLAT_HAND.mirror()])[:, ::-1] == image).mean() > 0.95


def test_two_hands_are_side_by_side_and_none_is_black() -> None:
    both = draw_hands([FLAT_HAND.mirror(), FLAT_HAND])
    middle = both[:, SIZE // 2 - 2 : SIZE // 2 + 2]
    assert both[:, : SIZE // 2].any()
    assert both[:, SIZE // 2 :].any()
    assert not middle.any()
    assert not draw_hands([]).any()


def test_a_second_shape_is_beside_the_first_with_an_arrow_between() -> None:
    fist = HandShape.of_frames("right", hand_xy(FIST)[None])
    image = draw_hands([FLAT_HAND], [fist])
    assert (image != draw_hands([fist], [FLAT_HAND])).any()
    assert image[:, SIZE // 2].any()
    placed = place_hands([FLAT_HAND], [fist])
    (_, first), (_, second) = placed.hands
    assert placed.arrow is not None
    tail, tip = placed.arrow
    assert first[:, 0].max() < tail[0] < tip[0] < second[:, 0].min()


def test_a_second_shape_of_both_hands_is_below_the_first() -> None:
    both = [FLAT_HAND.mirror(), FLAT_HAND]
    placed = place_hands(both, both)
    assert [hand.side for hand, _ in placed.hands] == ["right", "left", "right", "left"]
    assert placed.arrow is not None
    tail, tip = placed.arrow
    upper, lower = (
        np.concatenate([place for _, place in placed.hands[part]])
        for part in (slice(0, 2), slice(2, 4))
    )
    assert upper[:, 1].max() < tail[1] < tip[1] < lower[:, 1].min()
    assert upper[:, 0].min() < tip[0] < upper[:, 0].max()
