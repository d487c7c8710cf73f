"""Demonstration faults: whole clips, salutes and rests inside, strokes cut short."""

import pytest

from app.api.services.demonstration_faults import fault_in
from app.api.services.salute_ranges import Outline

CLIP = Outline(
    salutes=((0.5, 1.0), (4.0, 4.5)), strokes=((1.5, 3.5),), start=0.0, end=5.0, moving=(1.4, 3.6)
)
WITHOUT_SALUTES = Outline(salutes=(), strokes=(), start=0.0, end=6.0, moving=(2.0, 4.0))


@pytest.mark.parametrize(
    ("start", "end", "fault"),
    [
        (1.0, 4.0, None),  # the take
        (1.5, 3.5, None),  # its stroke
        (1.7, 3.5, None),  # a tenth less
        (2.5, 3.5, "is cut short: it keeps 1.0 of 2.0 s of the stroke"),
        (0.8, 3.5, "contains a Vulcan salute"),
        (0.0, 5.0, "is the whole clip, with 2 Vulcan salutes"),
    ],
)
def test_a_range_of_a_clip_with_salutes(start: float, end: float, fault: str | None) -> None:
    assert fault_in(CLIP, start, end) == fault


def test_rest_before_and_after_the_movement_is_a_fault() -> None:
    assert fault_in(WITHOUT_SALUTES, 0.0, 6.0) == (
        "contains 4.0 s of rest before and after the gesture"
    )
    assert fault_in(WITHOUT_SALUTES, 1.8, 4.2) is None
