"""A workspace: what it shows of a view, with a real viser server behind it."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import viser

from app.recognition import Gesture, PoseError
from app.ui.camera import CUBE, FLAT
from app.ui.workspace import Range, Workspace, compared_images, initial_frame
from tests.api.recordings import recording_of
from tests.api.running import until
from tests.recognition.damaged_clips import write_clip
from tests.recognition.held_takes import FIST, TWO, follow, hold
from tests.ui.views import view_in


@pytest.fixture
def workspace() -> Iterator[Workspace]:
    workspace = Workspace()
    yield workspace
    workspace.close()


def test_a_view_shows_the_frames_of_its_range(tmp_path: Path) -> None:
    view = view_in(tmp_path)
    shown = Range.of(view)
    time = view.recording.poses.time
    assert view.start is not None
    assert view.end is not None
    assert shown.poses.time[0] >= view.start
    assert shown.poses.time[-1] <= view.end
    assert time[shown.first] == shown.poses.time[0]
    assert len(shown.held) == len(shown.poses)
    assert len(Range.of(replace(view, start=None, end=None)).poses) == len(time)


def test_a_range_without_frames_is_refused_with_its_seconds(tmp_path: Path) -> None:
    with pytest.raises(PoseError, match=r"between 90 s and 91 s"):
        Range.of(replace(view_in(tmp_path), start=90.0, end=91.0))


def test_its_server_listens_on_loopback_only(workspace: Workspace) -> None:
    with socket.create_connection(("127.0.0.1", workspace.port), timeout=60):
        pass
    # Another address of this machine: a server on all addresses would answer here.
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", workspace.port), timeout=60)


def test_showing_a_view_stands_where_past_and_future_are_seen(
    workspace: Workspace, tmp_path: Path
) -> None:
    view = view_in(tmp_path)
    workspace.show(view)
    shown = Range.of(view)
    frames = len(shown.poses)
    assert workspace.view == view
    assert workspace.playback.frame == shown.first + initial_frame(frames)
    assert 0 < initial_frame(frames) < frames - 1
    assert workspace.playback.position.frames == len(view.recording.poses)


def test_of_a_long_clip_it_tells_whose_picture_is_shown(
    workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("filmstrip", "workspace"):
        monkeypatch.setattr(f"app.ui.{module}.MAX_FRAMES", 10)
    view = view_in(tmp_path)
    frames = len(view.recording.poses)
    video = write_clip(tmp_path / "long.mp4", frames=frames)
    view = replace(view, video=video, start=None, end=None)
    stride = -(-frames // 10)
    workspace.show(view)
    workspace.playback.seek(2 * stride + 1)
    # It comes by itself as soon as it is decoded.
    until(lambda: workspace.playback.position.picture == 2 * stride)
    workspace.playback.seek(4 * stride)
    until(lambda: workspace.playback.position.picture == 4 * stride)


def test_a_recognition_of_the_same_take_keeps_the_frame(
    workspace: Workspace, tmp_path: Path
) -> None:
    view = view_in(tmp_path, recognised=True, expected="line")
    workspace.show(replace(view, recognition=None))
    workspace.playback.seek(3)
    workspace.show(view)
    assert workspace.playback.frame == 3
    assert workspace.view == view


def test_another_range_of_the_clip_lets_the_clock_go_on_if_asked(
    workspace: Workspace, tmp_path: Path
) -> None:
    view = view_in(tmp_path)
    workspace.show(view)
    workspace.playback.seek(30)
    workspace.playback.play(0.25)
    workspace.show(replace(view, start=None), keep_frame=True)
    assert workspace.playback.playing
    assert workspace.playback.frame >= 30
    workspace.show(view)
    assert not workspace.playback.playing


def test_changing_the_colours_keeps_what_is_shown(workspace: Workspace, tmp_path: Path) -> None:
    view = view_in(tmp_path)
    workspace.set_dark(False)
    workspace.show(view)
    workspace.playback.seek(5)
    workspace.set_dark(True)
    assert workspace.view == view
    assert workspace.playback.frame == 5


def test_a_clip_in_which_nobody_moves_is_shown_all_the_same(
    workspace: Workspace, tmp_path: Path
) -> None:
    still = recording_of()
    nobody = replace(still, poses=replace(still.poses, xy=np.full_like(still.poses.xy, np.nan)))
    for recording in (still, nobody):
        view = replace(view_in(tmp_path), recording=recording, start=None, end=None)
        workspace.show(view)
        assert workspace.view == view


def test_what_was_compared_is_shown_with_its_captions(tmp_path: Path) -> None:
    for expected, captions in {
        None: ["this take", "circle (chosen)"],
        "circle": ["this take", "circle (chosen and expected)"],
        "line": ["this take", "line (expected)", "circle (chosen)"],
        "gone": ["this take", "circle (chosen)"],
    }.items():
        view = view_in(tmp_path, recognised=True, expected=expected)
        assert view.recognition is not None
        images = compared_images(view, view.recognition, Range.of(view).poses)
        assert [caption for caption, _ in images] == captions
        assert all(image.any() for _, image in images)


def test_a_take_is_drawn_with_the_landmarks_of_each_gesture_it_is_held_against(
    tmp_path: Path,
) -> None:
    view = view_in(tmp_path, recognised=True, expected="line")
    language, recognition = view.language, view.recognition
    assert language is not None
    assert recognition is not None
    circle, line = language.gestures
    both = replace(line, salient=("left_wrist", "right_wrist"))
    view = replace(view, language=replace(language, gestures=[circle, both]))
    images = compared_images(view, recognition, Range.of(view).poses)
    assert [caption for caption, _ in images] == [
        "this take, left wrist, right wrist",
        "this take, right wrist",
        "line (expected)",
        "circle (chosen)",
    ]


def test_a_take_of_two_hand_shapes_is_drawn_with_both(tmp_path: Path) -> None:
    view = view_in(tmp_path, recognised=True)
    assert view.language is not None
    assert view.recognition is not None
    take = follow(hold(TWO), hold(FIST))
    gesture = Gesture.from_demonstration(view.recognition.nearest, take)
    view = replace(view, language=replace(view.language, gestures=[gesture]))
    assert view.recognition is not None
    (_, drawn), (_, chosen) = compared_images(view, view.recognition, take)
    assert np.array_equal(drawn, chosen)


def test_opening_and_closing_at_once_leaves_standard_output_alone() -> None:
    before = sys.stdout
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: Workspace().close(), range(8)))
    assert sys.stdout is before


def test_a_range_of_one_frame_is_a_picture(workspace: Workspace, tmp_path: Path) -> None:
    view = view_in(tmp_path)
    moment = float(view.recording.poses.time[14])
    workspace.show(replace(view, start=moment, end=moment))
    assert workspace.playback.frame == 14
    workspace.playback.play(1)
    assert not workspace.playback.playing


def test_views_in_quick_succession_end_with_the_last(workspace: Workspace, tmp_path: Path) -> None:
    view = view_in(tmp_path)
    for end in (1.0, 2.4, 1.2, 2.0):
        workspace.show(replace(view, end=end))
        workspace.playback.play(4)
    assert workspace.view is not None
    assert workspace.view.end == 2.0
    workspace.playback.seek(1)
    until(lambda: workspace.playback.frame >= 1)


def test_the_first_view_is_flat_and_the_cube_is_there_and_back(
    workspace: Workspace, tmp_path: Path
) -> None:
    workspace.show(view_in(tmp_path))
    initial = workspace._server.initial_camera
    video = workspace._server.scene.get_handle_by_name("/video")
    assert isinstance(video, viser.ImageHandle)
    workspace.playback.seek(workspace.playback.frame + 10)
    assert tuple(initial.look_at) == FLAT.target
    workspace.set_flat(False)
    assert tuple(initial.position) == pytest.approx(CUBE.position)
    until(lambda: video.position[2] > 0)
    workspace.set_flat(True)
    assert tuple(initial.position) == pytest.approx(FLAT.position)
    assert video.position[2] == 0
