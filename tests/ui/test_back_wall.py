"""The back wall: the trajectory image hangs where the trails are, and as large as they are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition import PoseSequence
from app.recognition.features.trajectory_image import MARGIN, SIZE, draw
from app.recognition.poses.trajectory import Trajectory
from app.ui.geometry import CubeGeometry
from app.ui.scene import Wall
from app.ui.workspace import Range
from tests.ui.views import view_in

SALIENT = ("right_wrist",)


def assert_covers_the_trail(poses: PoseSequence) -> None:
    """Check that the drawing on the wall lies exactly behind the wrist's trail."""
    cube = CubeGeometry.from_poses(poses)
    drawing = draw(Trajectory.from_poses(poses).select(SALIENT))
    wall = Wall.from_drawing(cube, poses, SALIENT, drawing)
    wrist = cube.trail("right_wrist")[..., :2]
    low, high = wrist.min(axis=(0, 1)), wrist.max(axis=(0, 1))
    np.testing.assert_allclose(wall.centre, (low + high) / 2, atol=1e-3)
    inside = wall.side * (SIZE - 1 - 2 * MARGIN) / SIZE
    assert inside == pytest.approx(float((high - low).max()), rel=0.02)


def test_the_image_hangs_behind_the_trail_it_flattens(tmp_path: Path) -> None:
    assert_covers_the_trail(Range.of(view_in(tmp_path)).poses)


def test_without_a_torso_the_image_is_as_large_as_the_trail(tmp_path: Path) -> None:
    poses = Range.of(view_in(tmp_path)).poses.select(SALIENT)
    assert_covers_the_trail(poses)


def test_a_nearer_camera_makes_trail_and_image_larger_alike(tmp_path: Path) -> None:
    poses = Range.of(view_in(tmp_path)).poses
    nearer = replace(poses, xy=poses.xy * 1.5, frame_size=(960, 720))
    assert_covers_the_trail(nearer)
