"""Workspace of a browser tab: its view and its viser server on the loopback interface."""

from __future__ import annotations

import secrets
import time as clock
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

import numpy as np
import numpy.typing as npt
import viser

from app.recognition import Language, PoseSequence, Recognition, Recording
from app.recognition.errors import PoseError
from app.recognition.features.trajectory_image import draw, draw_hands
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_holds, keep_holds
from app.recognition.preprocessing.salience import find_salient_landmarks
from app.recognition.text.wording import humanize
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.ui.camera import CUBE, FLAT, CameraPose, ease
from app.ui.charts import mark_direction, mark_gesture
from app.ui.filmstrip import MAX_FRAMES, Filmstrip
from app.ui.geometry import CubeGeometry
from app.ui.loopback_server import quiet, start_server
from app.ui.panels import Inspector, TimeCursor
from app.ui.playback import Playback
from app.ui.scene import DARK, LIGHT, SpaceTimeCube, Wall

TRANSITION_SECONDS = 0.45
TRANSITION_STEPS = 12
"""Steps between the flat picture and the cube: enough to follow, few enough to wait for."""

SAME_ASPECT = 0.01
"""Difference of two aspect ratios that is rounding of pixels."""

INITIAL_SHARE = 0.45
"""Share of a range at which it is first shown: about half of the trail is past, half is to come,
and the back wall is visible."""


@dataclass(frozen=True)
class WorkspaceView:
    """Content of a workspace.

    Attributes
    ----------
    title
        Name of the clip.
    video, recording
        The clip's file and its landmark recording.
    start, end
        Seconds of the range on display; None is the clip's own start or end.
    recognition
        Recognition of the range; None before it is recognised.
    expected
        The expected label, if known; empty: none of the gestures.
    language
        The revision used for the recognition, for its gestures' images.

    """

    title: str
    video: Path
    recording: Recording
    start: float | None = None
    end: float | None = None
    recognition: Recognition | None = None
    expected: str | None = None
    language: Language | None = None

    @property
    def trigger(self) -> Trigger:
        """What begins and ends a take: the language's trigger, a salute without one."""
        return SALUTE if self.language is None else self.language.trigger


@dataclass(frozen=True, eq=False)
class Range:
    """The frames of a recording that lie in the range on display.

    Attributes
    ----------
    poses
        Their poses; at least one frame.
    first
        Index of the first one in the recording.
    held
        ``(T,)`` score in [0, 1] of the held trigger.

    """

    poses: PoseSequence
    first: int
    held: FloatArray

    @classmethod
    def of(cls, view: WorkspaceView) -> Range:
        """Return the range of a view, cut from its recording.

        Raises
        ------
        PoseError
            When no frame lies in the range.

        """
        poses = view.recording.poses
        start = -np.inf if view.start is None else view.start
        end = np.inf if view.end is None else view.end
        inside = np.flatnonzero((poses.time >= start) & (poses.time <= end))
        if not len(inside):
            raise PoseError(
                f"no frame of {view.title!r} lies between {start:g} s and {end:g} s; "
                "choose a longer range"
            )
        frames = slice(int(inside[0]), int(inside[-1]) + 1)
        cut = poses.between(float(poses.time[frames][0]), float(poses.time[frames][-1]))
        held = np.maximum(*view.trigger.score(poses, view.recording.salute))
        return cls(cut, frames.start, np.asarray(held, np.float64)[frames])


class Workspace:
    """A viser server with the space-time cube, the inspector, and their playback.

    Parameters
    ----------
    owner
        Name of the one who alone may see and change it; empty without names.
    dark
        Dark colours rather than light ones.

    """

    def __init__(self, *, owner: str = "", dark: bool = True) -> None:
        self.id = secrets.token_urlsafe(16)
        self.owner = owner
        self.last_seen = clock.monotonic()
        self._theme = DARK if dark else LIGHT
        self._lock = Lock()
        self._view: WorkspaceView | None = None
        self._filmstrip: Filmstrip | None = None
        self._shown: Range | None = None
        self._picture_frame = -1
        self._server = start_server()
        self._configure_theme()
        self._scene = SpaceTimeCube(self._server, self._theme)
        self._flat = True
        FLAT.start_with(self._server)
        self.playback = Playback(self._draw)
        self._cursor = TimeCursor(self._server.gui)
        self._inspector = Inspector(self._server.gui)
        self._server.on_client_connect(self._keep_fitted)

    @property
    def port(self) -> int:
        """The loopback port of its viser server."""
        return self._server.get_port()

    @property
    def view(self) -> WorkspaceView | None:
        """View on display."""
        return self._view

    @property
    def connected(self) -> bool:
        """Whether a browser is connected."""
        return bool(self._server.get_clients())

    def show(self, view: WorkspaceView, *, keep_frame: bool = False) -> None:
        """Show another clip, range or recognition; its frames arrive in the background.

        With `keep_frame`, the clock goes on where it is, if the clip stays the same. It does so in
        any case if the clip has grown, because its frames are being read.

        Raises
        ------
        PoseError
            When no frame of the clip lies in the view's range.

        """
        shown = Range.of(view)
        with self._lock:
            before, self._view = self._view, view
            grown = before is not None and _has_grown(before, view)
            if before is None or grown or _frames_of(before) != _frames_of(view):
                same = before is not None and _clip_of(before) == _clip_of(view)
                self._load(before, view, shown, keep_frame=grown or (keep_frame and same))
            if before is None or _answer_of(before) != _answer_of(view):
                found = view.recognition
                images = [] if found is None else compared_images(view, found, shown.poses)
                self._inspector.show_answer(found, view.expected, images)
        if before is None or _size_of(before) != _size_of(view):
            for client in self._server.get_clients().values():
                self._fit(client)

    def set_dark(self, dark: bool) -> None:
        """Change to dark or light colours."""
        theme = DARK if dark else LIGHT
        with self._lock:
            if theme == self._theme:
                return
            self._theme = theme
            self._configure_theme()
            self._scene.recolour(theme)
            if self._view is None:
                self._scene.clear()
                return
            self._draw_scene(self._view, Range.of(self._view))
            self.playback.redraw(self.playback.frame)

    def set_flat(self, flat: bool, *, animate: bool = True) -> None:
        """Show the picture flat, or the space-time cube; browsers show the transition."""
        with self._lock:
            if flat == self._flat:
                return
            self._flat = flat
            pose = FLAT if flat else CUBE
            pose.start_with(self._server)
            clients = list(self._server.get_clients().values())
            starts = [CameraPose.of(client.camera) for client in clients]
            steps = TRANSITION_STEPS if animate and clients else 1
            for step in range(1, steps + 1):
                share = ease(step / steps)
                self._scene.set_depth(1 - share if flat else share)
                for client, start in zip(clients, starts, strict=True):
                    start.blend(self._held(client, pose), share).apply(client)
                if step < steps:
                    clock.sleep(TRANSITION_SECONDS / steps)

    def _keep_fitted(self, client: viser.ClientHandle) -> None:
        """Show the whole flat picture to a browser, now and when its window changes."""
        aspect = client.camera.aspect

        def moved(camera: viser.CameraHandle) -> None:
            nonlocal aspect
            if abs(camera.aspect - aspect) > SAME_ASPECT:
                aspect = camera.aspect
                self._fit(client)

        client.camera.on_update(moved)
        self._fit(client)

    def _fit(self, client: viser.ClientHandle) -> None:
        """Move a browser's camera to where it sees all of the flat picture, where that is shown."""
        with self._lock:
            if self._flat:
                self._held(client, FLAT).apply(client)

    def _held(self, client: viser.ClientHandle, pose: CameraPose) -> CameraPose:
        """Return `pose`; the flat one so far back that the browser's window holds the picture."""
        if pose is not FLAT or self._view is None:
            return pose
        width, height = _size_of(self._view)
        return pose.holding(width / height, client.camera.aspect)

    def close(self) -> None:
        """Stop playback, decoding and the server."""
        self.playback.close()
        with self._lock:
            if self._filmstrip is not None:
                self._filmstrip.close()
            with quiet():
                self._server.stop()

    def _load(
        self, before: WorkspaceView | None, view: WorkspaceView, shown: Range, *, keep_frame: bool
    ) -> None:
        """Show other frames: scene, playback and charts at once, pictures as they are decoded."""
        first, times = shown.first, shown.poses.time
        last = first + len(times) - 1
        trajectory = self._draw_scene(view, shown)
        self._shown = shown
        moments = view.recording.poses.time.tolist()
        if keep_frame:
            self.playback.set_span((first, last), moments)
        else:
            self.playback.load(moments, first + initial_frame(len(times)), (first, last))
        self._inspector.show_tracks(trajectory, float(times[0]), (times, shown.held), view.trigger)
        if before is None or _pictures_of(before) != _pictures_of(view):
            self._decode(view, first, last)

    def _decode(self, view: WorkspaceView, first: int, last: int) -> None:
        """Decode the pictures of the whole clip, or only of the range if the clip is too long."""
        if self._filmstrip is not None:
            self._filmstrip.close()
        if len(view.recording.poses) <= MAX_FRAMES:
            first, last = 0, len(view.recording.poses) - 1
        self._filmstrip = Filmstrip(view.video, first, last, self._picture_arrived)
        self._filmstrip.start()

    def _picture_arrived(self, index: int) -> None:
        """Redraw if no nearer picture of the frame on display will be decoded."""
        frame = self.playback.frame
        if self._filmstrip is not None and index == self._filmstrip.kept(frame):
            self.playback.redraw(frame)

    def _draw_scene(self, view: WorkspaceView, shown: Range) -> Trajectory | None:
        """Draw the cube, and return the salient landmarks' trajectory that it shows."""
        cube = CubeGeometry.from_poses(shown.poses)
        trajectory, salient = find_salient_motion(shown.poses)
        wall = None
        if trajectory is not None and not (drawing := draw(trajectory)).empty:
            wall = Wall.from_drawing(cube, shown.poses, salient, drawing)
        self._scene.show(cube, salient, wall, view.recording.poses, shown.first)
        self._picture_frame = -1
        return trajectory

    def _draw(self, frame: int) -> int | None:
        """Draw a frame and return the index of its picture; called by the playback only."""
        with self._lock:
            if self._view is not None and self._shown is not None:
                # A frame due before the view changed may be beyond the new clip's end.
                times = self._view.recording.poses.time
                self._draw_locked(min(frame, len(times) - 1), self._shown, times)
            return None if self._picture_frame < 0 else self._picture_frame

    def _draw_locked(self, frame: int, shown: Range, times: FloatArray) -> None:
        image = None
        if self._filmstrip is not None:
            nearest = self._filmstrip.nearest(frame)
            if nearest is not None and nearest[0] != self._picture_frame:
                self._picture_frame, image = nearest
        self._scene.seek(frame, image)
        start, end = float(shown.poses.time[0]), float(shown.poses.time[-1])
        self._cursor.show((float(times[frame]) - start) / (end - start) if end > start else 0.0)

    def _configure_theme(self) -> None:
        self._server.gui.configure_theme(
            dark_mode=self._theme.dark,
            show_logo=False,
            show_share_button=False,
            brand_color=self._theme.accent,
        )


def initial_frame(frames: int) -> int:
    """Return the frame that is shown first: past and future trails are both visible there."""
    return round(INITIAL_SHARE * (frames - 1))


def find_salient_motion(poses: PoseSequence) -> tuple[Trajectory | None, tuple[str, ...]]:
    """Return the salient landmarks' trajectory and names; None and no names if nothing moves."""
    try:
        trajectory = Trajectory.from_poses(poses)
    except PoseError:
        return None, ()
    names = find_salient_landmarks(trajectory)
    return (trajectory.select(names), names) if names else (None, ())


def compared_images(
    view: WorkspaceView, recognition: Recognition, poses: PoseSequence
) -> list[tuple[str, npt.NDArray[np.uint8]]]:
    """Return the images that a recognition compared, with captions.

    The take is drawn as the recogniser drew it: with the salient landmarks of the gesture it is
    compared with. If those of the expected and the nearest gesture differ, there are two drawings.
    """
    nearest, expected = recognition.nearest, view.expected
    role = "nearest" if recognition.label is None else "chosen"
    known = {gesture.label: gesture for gesture in view.language.gestures} if view.language else {}
    captions = {nearest: f"{nearest} ({role})"}
    if expected == nearest:
        captions = {nearest: f"{nearest} ({role} and expected)"}
    elif expected:
        captions = {expected: f"{expected} (expected)", **captions}
    shown = [(caption, known[label]) for label, caption in captions.items() if label in known]
    sets = dict.fromkeys(gesture.salient for _, gesture in shown)
    images = []
    for names in sets:
        caption = f"this take, {', '.join(map(humanize, names))}" if len(sets) > 1 else "this take"
        if (image := _drawn(poses, names)) is not None:
            images.append((caption, image))
    return images + [(caption, mark_gesture(gesture)) for caption, gesture in shown]


def _drawn(poses: PoseSequence, names: tuple[str, ...]) -> npt.NDArray[np.uint8] | None:
    """Draw a take's paths of the named landmarks; None if it has none of them.

    Without names the take is drawn as its held hand shape, or two in sequence; None without one.
    """
    try:
        if not names:
            seen = Trajectory.from_poses(poses)
            held = keep_holds(seen, find_holds(poses, seen)).held_shapes
            return mark_direction(draw_hands(*held), None) if held else None
        trajectory = Trajectory.from_poses(poses).select(names)
        return mark_direction(draw(trajectory).image, trajectory)
    except PoseError:
        return None


def _frames_of(view: WorkspaceView) -> tuple[object, ...]:
    """Return the values of a view that determine the frames, trails and curves shown."""
    return view.video, view.start, view.end, view.trigger


def _clip_of(view: WorkspaceView) -> tuple[Path, int]:
    """Return the values of a view that determine the frames that its clip has."""
    return view.video, len(view.recording.poses)


def _has_grown(before: WorkspaceView, view: WorkspaceView) -> bool:
    """Return whether it is the same clip, of which more frames have been read."""
    (video, frames), (same, more) = _clip_of(before), _clip_of(view)
    return video == same and frames < more


def _size_of(view: WorkspaceView) -> tuple[int, int]:
    return view.recording.poses.frame_size


def _answer_of(view: WorkspaceView) -> tuple[object, ...]:
    """Return the values of a view that determine the answer shown."""
    return view.recognition, view.expected, view.start, view.end, view.video


def _pictures_of(view: WorkspaceView) -> tuple[object, ...]:
    """Return the values of a view that determine the pictures kept."""
    whole = len(view.recording.poses) <= MAX_FRAMES
    return _clip_of(view) if whole else (*_clip_of(view), view.start, view.end)
