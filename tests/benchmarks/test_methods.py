"""The methods that recognition is compared with: each behaves as its paper describes."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import PoseSequence
from benchmarks.methods import METHODS, find_method
from benchmarks.methods.base import Demonstration, Method
from benchmarks.methods.jackknife import Jackknife
from benchmarks.methods.point_cloud import greedy_cloud_distance
from benchmarks.sets.one_shot_draws import draws
from benchmarks.sets.recorded_sets import RecordedSet

TRAINED_FOR_LONG = {"hmm", "bi-lstm"}


def available(name: str) -> Method:
    """Make a method, or skip where its packages are not installed."""
    try:
        return find_method(name)()
    except ModuleNotFoundError as error:
        pytest.skip(f'needs {error.name}, which comes with the extra: pip install -e ".[bench]"')


def turned_round(poses: PoseSequence) -> PoseSequence:
    return replace(poses, xy=poses.xy[::-1], confidence=None)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow if name in TRAINED_FOR_LONG else ())
        for name in METHODS
    ],
)
def test_another_take_by_the_same_person_is_named(drawn: dict[str, RecordedSet], name: str) -> None:
    figures = drawn["one circle"]
    (draw,) = draws(figures, 1, 12, seed=2)
    method = available(name)
    method.fit(figures.show(draw.templates))
    named = [method.predict(figures.recordings[query]).nearest for query in draw.own]
    assert np.mean(np.array(named) == figures.labels[draw.own]) >= 0.75


def test_jackknife_knows_a_swipe_from_the_same_one_turned_round(
    drawn: dict[str, RecordedSet],
) -> None:
    swipes = drawn["swipes"]
    method = Jackknife()
    first = {label: np.flatnonzero(swipes.labels == label)[0] for label in ("left", "right")}
    method.fit([Demonstration(label, swipes.recordings[at]) for label, at in first.items()])
    right = swipes.recordings[np.flatnonzero(swipes.labels == "right")[1]]
    assert method.predict(right).label == "right"
    assert method.predict(turned_round(right)).label == "left"


def test_a_cloud_matched_with_itself_in_another_order_costs_nothing() -> None:
    random = np.random.default_rng(5)
    points = random.normal(size=(32, 2))
    assert greedy_cloud_distance(points, random.permutation(points)) == 0
    assert greedy_cloud_distance(points, points + 1) > 0


def test_the_published_code_calls_a_gesture_another_one_when_the_camera_stands_back(
    drawn: dict[str, RecordedSet],
) -> None:
    published = pytest.importorskip("benchmarks.methods.published", reason="needs mahotas")
    near = drawn["one circle"].recordings[0]
    middle = np.array(near.frame_size) / 2
    far = replace(near, xy=middle + (near.xy - middle) / 2)
    salient = published.salient_keypoints(near)
    assert salient == ("right_wrist",)
    frames = [published.frames_of(poses, salient) for poses in (near, far)]
    pictures = [published.picture(each, salient, published.QUERY_EDGES) for each in frames]
    fourier = [published.features(picture)[2] for picture in pictures]
    assert np.linalg.norm(fourier[0] - fourier[1]) > 0.3 * np.linalg.norm(fourier[0])


def test_the_published_code_needs_a_tenth_of_the_frame_to_see_a_movement(
    drawn: dict[str, RecordedSet],
) -> None:
    published = pytest.importorskip("benchmarks.methods.published", reason="needs mahotas")
    near = drawn["one circle"].recordings[0]
    middle = np.array(near.frame_size) / 2
    far = replace(near, xy=middle + (near.xy - middle) / 10)
    assert published.salient_keypoints(far) == near.landmarks
