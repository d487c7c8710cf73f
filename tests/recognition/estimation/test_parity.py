"""Our pipeline finds what MediaPipe's own library finds.

Over a few frames the two agree, on the first one to rounding. Over a whole clip tracking lets any
difference grow to the noise that the library shows against itself (see `agreement`): there the
typical frame is bounded by the tolerance or by that noise, whichever is larger.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from tests.conftest import SHARED_DATA
from tests.recognition.estimation.agreement import (
    Agreement,
    compare,
    disturbed,
    in_stretches,
    pooled,
    tracking,
)
from tests.recognition.estimation.clip_frames import clip_frames

# Two libraries over eight clips take minutes; the suite's limit is meant for one test of a clip.
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1500)]

BODY_TOLERANCE, HAND_TOLERANCE = 1.5e-3, 1e-3
"""Tolerance as a share of the frame, for the mean over upper-body and over hand landmarks."""

FIRST_SIGHT_TOLERANCE = 1e-4
"""Tolerance of the first frame, as a share of its size: a fifteenth of a pixel at 640 x 480 is
rounding; a wrong rule costs more."""

COUNT_TOLERANCE = 0.01
"""Share of the detections by which the two libraries may differ."""

STRETCH, STRETCHES, APART = 5, 2, 3
"""Frames between two resets, number of such stretches, and step from one used frame to the next."""

TRACKED_FRAMES = 24
"""Frames per clip of the comparison without resets."""

NOISE_MARGIN = 2.0
"""The median of 40 frames' noise, each alike to its neighbours, is known to about a factor two."""

WITHOUT_BODY = "decord_pancake.mkv"
"""Shows hands and a stove: what is compared there is whether a body is found, not where."""

TRACKED = (WITHOUT_BODY, "diver_follow_me.webm", "circle-demonstration.mp4")
"""Clips of the comparison without resets: one without a body, one real diver, one rendering."""


@pytest.fixture(scope="module")
def ours(installed_models: None) -> Iterator[OnnxPoseEstimator]:
    estimator = OnnxPoseEstimator(hands="palm")
    yield estimator
    estimator.close()


@pytest.fixture(scope="module")
def clips(sample_clips: Path) -> tuple[Path, ...]:
    """Return all available real clips and two of our own."""
    shared = sorted(
        path
        for path in (SHARED_DATA / "clips").glob("*")
        if path.suffix in {".mp4", ".mkv", ".webm"}
    )
    return (*shared, *sorted(sample_clips.glob("*.mp4"))[::7][:2])


@pytest.fixture(scope="module")
def stretches(
    ours: OnnxPoseEstimator, library: MediaPipeEstimator, clips: tuple[Path, ...]
) -> Mapping[str, Agreement]:
    """Compare the two over short stretches of every clip."""
    return {
        clip.name: compare(
            in_stretches(ours, STRETCH),
            in_stretches(library, STRETCH),
            clip_frames(clip, STRETCH * STRETCHES, every=APART),
        )
        for clip in clips
    }


@pytest.fixture(scope="module")
def tracked(
    ours: OnnxPoseEstimator, library: MediaPipeEstimator, clips: tuple[Path, ...]
) -> Mapping[str, Agreement]:
    """Compare the two over the beginning of a few clips, tracking throughout."""
    return {
        clip.name: compare(tracking(ours), tracking(library), clip_frames(clip, TRACKED_FRAMES))
        for clip in clips
        if clip.name in TRACKED
    }


def test_first_frames_agree_to_rounding(stretches: Mapping[str, Agreement]) -> None:
    for name, agreement in stretches.items():
        assert agreement.body_errors[:1].sum() <= FIRST_SIGHT_TOLERANCE, name


def test_landmarks_agree_over_all_clips(stretches: Mapping[str, Agreement]) -> None:
    together = pooled(stretches.values())
    assert together.body <= BODY_TOLERANCE
    assert together.hand <= HAND_TOLERANCE


def test_as_many_bodies_and_hands_are_found(stretches: Mapping[str, Agreement]) -> None:
    together = pooled(stretches.values())
    for mine, theirs in (together.bodies, together.hands):
        assert abs(mine - theirs) <= COUNT_TOLERANCE * theirs


def test_tracking_stays_with_the_library_as_long_as_the_library_stays_with_itself(
    tracked: Mapping[str, Agreement], library: MediaPipeEstimator, clips: tuple[Path, ...]
) -> None:
    again = MediaPipeEstimator()
    for clip in (clip for clip in clips if clip.name in tracked):
        typical = tracked[clip.name].typical_body
        if typical > BODY_TOLERANCE:
            frames = clip_frames(clip, TRACKED_FRAMES)
            noise = compare(tracking(library), disturbed(tracking(again)), frames)
            assert typical <= NOISE_MARGIN * noise.typical_body, clip.name
    again.close()


def test_no_bodies_are_invented(tracked: Mapping[str, Agreement], shared_data: Path) -> None:
    assert (shared_data / "clips" / WITHOUT_BODY).exists()
    mine, theirs = tracked[WITHOUT_BODY].bodies
    assert mine <= theirs * (1 + COUNT_TOLERANCE)
