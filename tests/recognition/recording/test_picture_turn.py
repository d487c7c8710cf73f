"""Picture turn: a diver who lies on the side, or upside down, is told from shoulders and hips."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.recognition.recording.extraction import find_turn
from app.recognition.recording.recording import Recording


@pytest.mark.parametrize("turn", [0, 90, 180, 270])
@pytest.mark.parametrize("lean", [-25, 0, 25])
def test_a_diver_sideways_or_upside_down_is_told_from_shoulders_and_hips(
    sample_recording: Callable[[str], Recording], turn: int, lean: int
) -> None:
    poses = sample_recording("line-test-1").poses
    # The picture was turned counter-clockwise, as that of a camera held another way.
    angle = np.radians(lean - turn)
    turned = poses.xy @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    assert find_turn(replace(poses, xy=turned)) == turn


def test_who_points_at_the_camera_or_turns_about_is_not_called_sideways(
    sample_recording: Callable[[str], Recording],
) -> None:
    poses = sample_recording("line-test-1").poses
    lying = poses.xy[..., ::-1]
    half = np.where(np.arange(len(poses))[:, None, None] % 2, lying, poses.xy)
    assert find_turn(replace(poses, xy=half)) == 0
    for lean, turn in ((45.0, 0), (60.0, 270)):
        angle = np.radians(lean)
        by = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        assert find_turn(replace(poses, xy=poses.xy @ by)) == turn
    assert find_turn(replace(poses, xy=lying * [0.1, 1.0])) == 0
    assert find_turn(replace(poses, xy=np.full_like(poses.xy, np.nan))) == 0
