"""Extraction: runs a pose estimator on every frame of a clip and keeps the landmarks.

`record` does so. `find_turn` tells by how much the pictures must be turned for the diver to be
upright in them, and `explain_missing_salutes` why the report of a clip's quality finds no take
between two salutes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Final, TypedDict

import numpy as np
from typing_extensions import Unpack

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator, finds_hands, list_landmarks
from app.recognition.estimation.water import WaterCorrection, WaterSight
from app.recognition.poses.frame import FrameLandmarks, Hand
from app.recognition.poses.landmarks import HIPS, POSE_LANDMARKS, SHOULDERS, WRISTS
from app.recognition.poses.sequence import FloatArray, PoseSequence, join_sequences
from app.recognition.poses.skeletons import find_missing_landmarks
from app.recognition.poses.trajectory import TURNED_AWAY, Trajectory
from app.recognition.recording.people import People, keep_person, see_people
from app.recognition.recording.recording import Recording, place_hands, tell_clock
from app.recognition.recording.salute import (
    DROPOUT_SECONDS,
    ENTER_SCORE,
    FEW_HANDS,
    SHORTEST_TAKE,
    find_held,
)
from app.recognition.recording.video import (
    FrameSource,
    Turn,
    VideoFrame,
    VideoInfo,
    read_frames,
)
from app.recognition.recording.video_limits import VideoLimits
from app.recognition.text.wording import humanize

OFTEN_OUTSIDE: Final = 0.5
"""Share of the frames from which on a wrist outside of the picture is told: half of a take."""


def explain_missing_salutes(
    poses: PoseSequence,
    scores: FloatArray,
    hands: Sequence[Sequence[Hand]],
    without_fingers: int = 0,
    odd: Sequence[str] = (),
) -> Iterator[str]:
    """Yield why a take has no salutes around it, with a remedy; nothing where both were held.

    Parameters
    ----------
    poses
        Of T frames.
    scores
        ``(T,)`` scores of the best hand in each frame.
    hands
        Per frame the hands that were found.
    without_fingers
        Number of the other frames in which the place of a hand was found.
    odd
        What is odd about the file or its clock, and may be the reason.

    """
    if odd and len(find_held(poses.time, scores)) < 2:
        yield f"two salutes were not seen, and something else is odd: {odd[0]}"
        return
    frames, with_hand = len(hands), sum(map(bool, hands))
    seen = with_hand + without_fingers
    facing = Trajectory.from_poses(poses).facing if poses.seen.any() else None
    outside, wrist = max((_count_outside(poses, each), each) for each in WRISTS)
    if scores.max(initial=0.0) > ENTER_SCORE:
        yield from _describe_missed_salute(poses.time, scores, hands)
    elif facing is not None and abs(facing) >= TURNED_AWAY:
        yield (
            f"no salute in any of {frames} frames: the diver is turned {abs(facing):.0f} degrees "
            "away; face the camera"
        )
    elif outside >= OFTEN_OUTSIDE * frames:
        yield (
            f"the {humanize(wrist)} lies outside of the picture in {outside} of {frames} frames, "
            "so no salute is seen; film from farther, or with the diver in the middle"
        )
    elif with_hand < FEW_HANDS * frames <= seen:
        yield (
            f"hands seen in {seen / frames:.0%} of {frames} frames, their fingers in "
            f"{with_hand / frames:.0%}: gloves? Choose a trigger of the arms"
        )
    elif not with_hand:
        yield (
            f"no hand in any of {frames} frames, so no salute can be seen; choose the "
            "gesture's range by hand, choose a trigger of the arms, or film from nearer"
        )
    elif with_hand < FEW_HANDS * frames:
        yield (
            f"hands seen in {with_hand / frames:.0%} of {frames} frames: choose a trigger of "
            "the arms, or film from nearer"
        )
    else:
        yield (
            f"no salute in any of {frames} frames; choose the gesture's range by hand, or "
            "salute with the palm or back of the hand towards the camera"
        )


def _count_outside(poses: PoseSequence, landmark: str) -> int:
    """Count the frames in which a landmark is placed outside of the picture."""
    if landmark not in poses.landmarks:
        return 0
    xy = poses.xy[:, poses.landmarks.index(landmark)]
    return int(((xy < 0) | (xy > poses.frame_size)).any(axis=1).sum())


def _describe_missed_salute(
    time: FloatArray, scores: FloatArray, hands: Sequence[Sequence[Hand]]
) -> Iterator[str]:
    """Yield which of the two salutes around a take was not seen, when, and in how many frames.

    Parameters as in `explain_missing_salutes`.
    """
    held = find_held(time, scores)
    seen = scores >= ENTER_SCORE
    if len(held) > 1:
        return
    name, told, missing = "salute", "no salute was held for long enough", np.ones_like(seen)
    if held:
        ((start, end),) = held
        is_first = end - time[0] < time[-1] - start
        name, other = ("second", "first") if is_first else ("first", "second")
        told = f"the {other} salute was seen at {start:.1f} to {end:.1f} s"
        missing = time > end + DROPOUT_SECONDS if is_first else time < start - DROPOUT_SECONDS
    if not missing.any():
        return
    # Where on that side a salute is seen most, for as long as a take lasts at least.
    there = np.flatnonzero(missing)
    ends = np.searchsorted(time[there], time[there] + SHORTEST_TAKE)
    before = np.concatenate([[0], np.cumsum(seen[there])])
    counts = before[ends] - before[:-1]
    at = int(counts.argmax())
    if counts[at]:
        span = f"{time[there[at]]:.1f} to {time[there[ends[at] - 1]]:.1f} s"
        in_part = f"seen in {counts[at]} of {ends[at] - at} frames at {span}"
    else:
        with_hand = sum(bool(hands[each]) for each in there.tolist())
        in_part = f"not seen; a hand was in {with_hand} of {len(there)} frames there"
    what = f"the {name} one was" if held else "one was"
    yield f"{told}; {what} {in_part}; hold both salutes longer, and nearer to the camera"


TURNED_SHARE: Final = 0.8
"""Share of the frames with a body in which it must lie in one direction, to be called turned."""

TURNED_DEGREES, MOST_LEAN = 40.0, 60.0
"""Farthest of a torso from a quarter turn, in the median and in these frames: divers lean a little,
and bend, whatever way up they are."""

LEAST_TORSO: Final = 0.5
"""Least length of a torso in shoulder widths: that of somebody who points at the camera is short,
and its direction says nothing."""

FEWEST_TURNED: Final = 10
"""Fewest frames with a body from which it is told."""

HEAD_POINTS: Final[dict[Turn, str]] = {
    90: "lies on the side, the head to the left,",
    180: "is upside down",
    270: "lies on the side, the head to the right,",
}
"""How a diver is seen in a picture that must be turned by so much."""


def find_turn(poses: PoseSequence) -> Turn:
    """Return by how much the picture must be turned for the person to stand upright in it.

    0 where shoulders and hips do not lie sideways or upside down in nearly all frames.
    """
    if not {*SHOULDERS, *HIPS} <= set(poses.landmarks):
        return 0
    shoulders, hips = poses.select(SHOULDERS).xy, poses.select(HIPS).xy
    up = shoulders.mean(axis=1) - hips.mean(axis=1)
    width = np.hypot(*(shoulders[:, 0] - shoulders[:, 1]).T)
    length = np.hypot(*up.T)
    # The comparisons are False for NaN.
    up = up[(length > 0) & (length >= LEAST_TORSO * width)]
    if len(up) < FEWEST_TURNED:
        return 0
    # Clockwise in the picture, whose y points down, from upwards.
    lean = np.degrees(np.arctan2(up[:, 0], -up[:, 1]))
    for turn in HEAD_POINTS:
        off = (lean + turn + 180) % 360 - 180
        steady = (np.abs(off) <= MOST_LEAN).mean() >= TURNED_SHARE
        if steady and abs(np.median(off)) <= TURNED_DEGREES:
            return turn
    return 0


NOBODY: Final = FrameLandmarks(None, ())

Progress = Callable[[int, int], None]
"""``progress(done, total)`` frames. `total` is an estimate where the container does not count them.
Raising an exception in it cancels the work."""
Observer = Callable[[VideoFrame, FrameLandmarks], None]
"""``observer(frame, found)``: a frame of the clip and its landmarks. Raising an exception in it
cancels the work."""
KeepSoFar = Callable[[Recording], None]
"""``keep_so_far(recording)``: what is recorded until now. The person whose body counts is chosen
over these frames; the end of the clip may show that it is another one."""


class Following(TypedDict, total=False):
    """Keywords of all who record frames, see `record`: what is called while they are read."""

    progress: Progress | None
    observer: Observer | None
    keep_so_far: KeepSoFar | None


FIRST_SECONDS: Final = 2.0
"""Seconds of a clip before the first recording so far, and between two of them at least."""

GROWTH: Final = 1.3
"""How much longer each recording so far is than the one before: all of them together cost less
than five times the last one."""


def record(
    clip: str | Path,
    *,
    estimator: PoseEstimator | None = None,
    limits: VideoLimits | None = None,
    water: WaterCorrection = "auto",
    turn: Turn = 0,
    **following: Unpack[Following],
) -> Recording:
    """Find body and hands in every frame of a clip.

    One frame is in memory at a time; only the landmarks grow with the clip.

    Parameters
    ----------
    clip
        The video file.
    estimator
        The pose estimator; it is reset first and left open. None: the default one. The poses have
        the landmarks that it can find.
    limits
        Limits of the clip's size and length.
    water
        Whether colour and contrast are corrected before estimation: as the models find most
        (`WaterSight`), always, or never.
    turn
        By how much the pictures are turned before anything is found in them.
    **following
        The keywords of `Following`: `progress` is called after every frame, `observer` with the
        landmarks of every frame, before `progress` counts it, and `keep_so_far` now and then with
        what is recorded until then.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.
    ModelError
        When the default estimator's models are not installed.

    """
    with read_frames(clip, limits, turn) as reader:
        return record_frames(reader, estimator=estimator, water=water, **following)


def record_frames(
    frames: FrameSource,
    *,
    estimator: PoseEstimator | None = None,
    water: WaterCorrection = "auto",
    progress: Progress | None = None,
    observer: Observer | None = None,
    keep_so_far: KeepSoFar | None = None,
) -> Recording:
    """Find body and hands in the frames of an open source; see `record`.

    Raises
    ------
    VideoError
        When a frame cannot be read, or breaks a limit.
    ModelError
        When the default estimator's models are not installed.

    """
    with closing(create_estimator()) if estimator is None else nullcontext(estimator) as used:
        sight = WaterSight(used, water)
        sight.reset()
        collector = _Collector(frames.info, used)
        done, due = 0, FIRST_SECONDS
        for frame in read_ahead(frames):
            found = sight.estimate(frame.image, frame.time)
            collector.add(frame.time, found)
            if observer is not None:
                observer(frame, found)
            done = frame.index + 1
            if keep_so_far is not None and frame.time >= due:
                due = max(frame.time + FIRST_SECONDS, GROWTH * frame.time)
                keep_so_far(collector.recording(frames.warnings))
            if progress is not None:
                progress(done, _expected_frames(frames.info, frame))
    if progress is not None:
        progress(done, done)
    return collector.recording(frames.warnings)


def extract_poses(
    clip: str | Path,
    *,
    estimator: PoseEstimator | None = None,
    progress: Progress | None = None,
    water: WaterCorrection = "auto",
) -> PoseSequence:
    """Find the body in every frame of a clip; see `record`, which also keeps the hands."""
    return record(clip, estimator=estimator, progress=progress, water=water).poses


def build_frame_sequence(
    found: FrameLandmarks,
    time: float,
    frame_size: tuple[int, int],
    landmarks: tuple[str, ...] = POSE_LANDMARKS,
) -> PoseSequence:
    """Return the landmarks of one frame as a pose sequence of length 1.

    Parameters
    ----------
    found
        The landmarks of the frame; without a body all of them are NaN.
    time
        Seconds.
    frame_size
        Width and height of the image in pixels.
    landmarks
        Landmarks to keep: those that the estimator can find (`list_landmarks`).

    """
    if found.body is None:
        xy, visibility = np.full((len(POSE_LANDMARKS), 2), np.nan), np.zeros(len(POSE_LANDMARKS))
        world = None
    else:
        seen = np.isfinite(found.body.xy).all(axis=1, keepdims=True)
        xy = np.where(seen, found.body.xy, np.nan)
        # NaN becomes 0, unlike in np.clip.
        visibility = np.fmin(np.fmax(found.body.visibility, 0), 1)
        world = found.body.world
        if world is not None:
            world = world.astype(np.float32).astype(np.float64)  # as precise as `Recording.save`
    wrists = xy[[POSE_LANDMARKS.index(name) for name in WRISTS]]
    moment = PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=xy[None],
        confidence=visibility[None],
        time=np.array([time]),
        frame_size=frame_size,
        world=None if world is None else world[None],
        hands=place_hands([found.hands], wrists[None]),
    )
    return moment if landmarks == POSE_LANDMARKS else moment.select(landmarks)


class _Collector:
    """Collects the landmarks of everybody in frame after frame into a `Recording`."""

    def __init__(self, info: VideoInfo, estimator: PoseEstimator) -> None:
        self._info = info
        self._landmarks, self._hands_sought = list_landmarks(estimator), finds_hands(estimator)
        self._moments: list[PoseSequence] = []
        self._hands: list[tuple[Hand, ...]] = []
        self._with_place = 0
        self._crowded: dict[int, FrameLandmarks] = {}
        self._times: list[float] = []
        self._people = People()

    def add(self, time: float, found: FrameLandmarks) -> None:
        # Where one person is seen throughout, nothing of the frames is kept but the landmarks.
        if found.others or self._crowded:
            self._crowded[len(self._times)] = found
        self._people.add(time, *see_people(found))
        self._times.append(time)
        self._moments.append(self._build_moment(time, found))
        self._hands.append(_sort_hands(found))
        self._with_place += bool(found.places and not found.hands)

    def recording(self, warnings: tuple[str, ...]) -> Recording:
        """Return the recording of the person whose body counts, chosen over all frames so far."""
        choice = self._people.choose()
        moments, kept_hands = list(self._moments), list(self._hands)
        for row, place in enumerate(choice.index):
            if row in self._crowded or place is None:
                found = keep_person(self._crowded.get(row, NOBODY), place)
                moments[row] = self._build_moment(self._times[row], found)
                kept_hands[row] = _sort_hands(found)
        hands = tuple(kept_hands)
        poses = join_sequences(moments)
        missing = sum(place is None for place in choice.index)
        return Recording(
            poses=poses,
            hands=hands,
            salute=choice.salute,
            warnings=(
                *warnings,
                *choice.notes,
                *self._warn_of_body(missing, several=bool(choice.notes)),
                *_warn_of_turn(poses),
            ),
            people=choice.count,
            salute_warnings=tuple(
                explain_missing_salutes(
                    poses,
                    choice.salute,
                    hands,
                    self._with_place,
                    (*warnings, *tell_clock(poses.time)),
                )
                if self._hands_sought
                else ()
            ),
        )

    def _build_moment(self, time: float, found: FrameLandmarks) -> PoseSequence:
        size = (self._info.width, self._info.height)
        return build_frame_sequence(found, time, size, self._landmarks)

    def _warn_of_body(self, missing: int, *, several: bool) -> Iterator[str]:
        """Yield what is missing of the body, as sentences with counts.

        Parameters
        ----------
        missing
            Number of frames without the body.
        several
            Whether several people are seen, so that others may be seen in these frames.

        """
        if missing:
            who = "that person is not seen" if several else "no person"
            yield f"{who} in {missing} of {len(self._moments)} frames"
        if names := find_missing_landmarks(self._landmarks):
            yield f"this pose model gives no {', '.join(names)}"


def _warn_of_turn(poses: PoseSequence) -> Iterator[str]:
    if turn := find_turn(poses):
        yield (
            f"the diver {HEAD_POINTS[turn]} in the picture, so gestures shown upright are not "
            f"recognised; turn the picture by {turn} degrees clockwise (--turn {turn})"
        )


def _sort_hands(found: FrameLandmarks) -> tuple[Hand, ...]:
    return tuple(sorted(found.hands, key=lambda hand: hand.size, reverse=True))


def read_ahead(frames: Iterable[VideoFrame]) -> Iterator[VideoFrame]:
    """Yield frames; the next one is decoded in another thread meanwhile."""
    coming = iter(frames)
    with ThreadPoolExecutor(1, "decoder") as decoder:
        pending = decoder.submit(next, coming, None)
        while (frame := pending.result()) is not None:
            pending = decoder.submit(next, coming, None)
            yield frame


def _expected_frames(info: VideoInfo, frame: VideoFrame) -> int:
    """Estimate the clip's number of frames from those read so far, never below it."""
    done = frame.index + 1
    if info.frames is not None:
        return max(done, info.frames)
    if info.duration is None or frame.time <= 0:
        return done
    return max(done, round(done * info.duration / frame.time))
