"""The scene in a real viser server: what is drawn, and how it moves."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import viser

from app.recognition.features.trajectory_image import draw
from app.recognition.poses.trajectory import Trajectory
from app.ui.geometry import CubeGeometry
from app.ui.scene import DARK, LIGHT, SpaceTimeCube, Wall, text_image
from app.ui.workspace import Range
from tests.ui.views import view_in

SALIENT = ("right_wrist",)


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def shown(tmp_path: Path) -> Range:
    return Range.of(view_in(tmp_path))


def wall_behind(shown: Range) -> Wall:
    drawing = draw(Trajectory.from_poses(shown.poses).select(SALIENT))
    return Wall.from_drawing(CubeGeometry.from_poses(shown.poses), shown.poses, SALIENT, drawing)


def test_the_parts_of_the_scene_follow_the_frame(server: viser.ViserServer, shown: Range) -> None:
    scene = SpaceTimeCube(server, DARK)
    scene.set_depth(1.0)
    cube = CubeGeometry.from_poses(shown.poses)
    scene.show(cube, SALIENT, wall_behind(shown), shown.poses, 0)
    image = np.full((12, 16, 3), 200, np.uint8)
    scene.seek(10, image)
    video = server.scene.get_handle_by_name("/video")
    assert isinstance(video, viser.ImageHandle)
    np.testing.assert_allclose(video.position, [0, 0, cube.depth[10]], atol=1e-6)
    np.testing.assert_array_equal(video.image, image)
    trail = server.scene.get_handle_by_name("/trails/right_wrist/past")
    assert isinstance(trail, viser.LineSegmentsHandle)
    assert len(trail.points) == len(trail.colors) == 10
    scene.seek(3, None)
    assert len(trail.points) == 3
    np.testing.assert_array_equal(video.image, image)


def test_outside_the_range_the_plane_stands_at_its_ends(
    server: viser.ViserServer, tmp_path: Path
) -> None:
    view = view_in(tmp_path)
    shown = Range.of(view)
    scene = SpaceTimeCube(server, DARK)
    scene.set_depth(1.0)
    cube = CubeGeometry.from_poses(shown.poses)
    scene.show(cube, SALIENT, None, view.recording.poses, shown.first)
    video = server.scene.get_handle_by_name("/video")
    joints = server.scene.get_handle_by_name("/skeleton/joints")
    assert isinstance(video, viser.ImageHandle)
    assert isinstance(joints, viser.PointCloudHandle)
    for frame, depth in ((0, 0.0), (len(view.recording.poses) - 1, cube.back)):
        scene.seek(frame, None)
        assert video.position[2] == pytest.approx(depth)
        whole = CubeGeometry.from_poses(view.recording.poses)
        expected = whole.joints(whole.points[frame])
        np.testing.assert_allclose(joints.points[:, :2], expected[:, :2], atol=1e-6)


def test_another_recording_leaves_nothing_of_the_last_one(
    server: viser.ViserServer, shown: Range
) -> None:
    scene = SpaceTimeCube(server, DARK)
    scene.set_depth(1.0)
    cube = CubeGeometry.from_poses(shown.poses)
    scene.show(cube, SALIENT, wall_behind(shown), shown.poses, 0)
    scene.show(cube, ("nose",), None, shown.poses, 0)
    assert server.scene.get_handle_by_name("/trails/right_wrist/past") is None
    assert server.scene.get_handle_by_name("/wall/image") is None
    scene.clear()
    assert server.scene.get_handle_by_name("/video") is None
    scene.seek(0, None)


def test_text_has_ink_and_nothing_around_it() -> None:
    image = text_image("1.5 s", LIGHT.ink)
    assert (image[..., :3] == LIGHT.ink).all()
    border = np.concatenate([image[0, :, 3], image[-1, :, 3], image[:, 0, 3], image[:, -1, 3]])
    assert not border.any()
    assert image[..., 3].max() == 255


def test_flat_everything_lies_before_the_picture_and_the_cube_is_hidden(
    server: viser.ViserServer, shown: Range
) -> None:
    scene = SpaceTimeCube(server, DARK)
    cube = CubeGeometry.from_poses(shown.poses)
    scene.show(cube, SALIENT, wall_behind(shown), shown.poses, 0)
    scene.seek(10, np.full((12, 16, 3), 200, np.uint8))
    handles = {
        name: server.scene.get_handle_by_name(name)
        for name in ("/video", "/trails/right_wrist/past", "/trails/right_wrist/ahead")
    }
    video, past, ahead = handles.values()
    assert isinstance(video, viser.ImageHandle)
    assert isinstance(past, viser.LineSegmentsHandle)
    assert isinstance(ahead, viser.LineSegmentsHandle)
    assert video.position[2] == 0
    for trail in (past, ahead):
        assert (trail.points[..., 2] < 0).all()
        assert np.ptp(trail.points[..., 2]) < 1e-6
    for name in ("/cube/edges", "/wall/image", "/trails/others"):
        part = server.scene.get_handle_by_name(name)
        assert part is not None
        assert not part.visible
    scene.set_depth(1.0)
    assert np.ptp(ahead.points[..., 2]) == pytest.approx(cube.back, rel=0.1)
    edges = server.scene.get_handle_by_name("/cube/edges")
    assert edges is not None
    assert edges.visible
