"""Limits: what is just allowed passes, one more is refused with the limit named."""

from collections.abc import Callable

import pytest

from app.recognition.errors import VideoError
from app.recognition.recording.video_limits import VideoLimits

LIMITS = VideoLimits(pixels=100, frames=10, seconds=2.5)


@pytest.mark.parametrize(
    ("check", "allowed", "refused", "limit"),
    [
        (lambda n: LIMITS.require_pixels(10, n), 10, 11, "0.0001 million"),
        (LIMITS.require_frames, 10, 11, "limit of 10"),
        (LIMITS.require_seconds, 2.5, 2.6, "limit of 2.5 s"),
    ],
)
def test_a_limit_is_the_last_thing_allowed(
    check: Callable[[float], None], allowed: float, refused: float, limit: str
) -> None:
    check(allowed)
    with pytest.raises(VideoError) as refusal:
        check(refused)
    assert limit in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_the_defaults_take_what_action_cameras_record() -> None:
    limits = VideoLimits()
    limits.require_pixels(5312, 2988)
    limits.require_frames(10 * 60 * 60)
    limits.require_seconds(10 * 60)
    with pytest.raises(VideoError):
        limits.require_pixels(8192, 8192)
    with pytest.raises(VideoError):
        limits.require_frames(100_000)
    with pytest.raises(VideoError):
        limits.require_seconds(36_000)
