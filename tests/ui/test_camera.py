"""Cameras of the scene: the transition from one to the other."""

from __future__ import annotations

import math

import pytest

from app.ui.camera import CUBE, FLAT, ease


def test_the_flat_camera_sees_the_height_of_the_picture() -> None:
    distance = math.dist(FLAT.position, FLAT.target)
    assert 2 * distance * math.tan(FLAT.fov / 2) == pytest.approx(1.0)
    assert FLAT.position[:2] == FLAT.target[:2] == (0.0, 0.0)


def test_the_way_begins_and_ends_at_the_two_cameras() -> None:
    assert FLAT.blend(CUBE, ease(0.0)) == FLAT
    end = FLAT.blend(CUBE, ease(1.0))
    assert end.position == pytest.approx(CUBE.position)
    assert end.fov == pytest.approx(CUBE.fov)
    assert 0 < ease(0.1) < 0.1
