"""YOLO-pose exports: real inference on drawn markers, and refusals of other files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.estimation.factory import create_estimator, finds_hands, list_landmarks
from app.recognition.estimation.water import Examiner
from app.recognition.estimation.yolo_pose import YoloPose, decode_people
from app.recognition.poses.frame import Body, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import COCO_17
from tests.recognition.estimation.marker_models import (
    BODY_COLOURS,
    draw_markers,
    save_hand_detector,
    save_hand_keypoints,
    save_yolo_pose,
)

COLUMNS = [POSE_LANDMARKS.index(name) for name in COCO_17]
OTHERS = [index for index in range(len(POSE_LANDMARKS)) if index not in COLUMNS]


@pytest.fixture(scope="module", params=["candidates", "suppressed"])
def model(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> YoloPose:
    """Return an export of either form, with the real one's shapes."""
    path = tmp_path_factory.mktemp("yolo") / "markers-pose.onnx"
    return YoloPose(save_yolo_pose(path, suppressed=request.param == "suppressed"))


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> YoloPose:
    """Return an export with a smaller input (``imgsz=320``), which runs faster."""
    return YoloPose(save_yolo_pose(tmp_path_factory.mktemp("yolo") / "small.onnx", side=320))


def body_at(left: float, top: float, *, spacing: float = 40.0) -> FloatArray:
    """``(17, 2)`` places in four columns, no two markers touching."""
    return np.array(
        [[left + spacing * (index % 4), top + spacing * (index // 4)] for index in range(17)]
    )


def picture(*bodies: FloatArray, size: tuple[int, int] = (640, 360), radius: float = 9) -> Image:
    image = np.zeros((size[1], size[0], 3), np.uint8)
    for places in bodies:
        draw_markers(image, places, BODY_COLOURS, radius)
    return image


def found(model: YoloPose, image: Image, time: float = 0.0) -> Body:
    body = model.track(image, time).body
    assert body is not None
    return body


@pytest.mark.parametrize("size", [(640, 360), (360, 640), (1280, 720), (500, 500)])
def test_keypoints_are_pixels_of_the_image_whatever_its_size(
    model: YoloPose, size: tuple[int, int]
) -> None:
    model.reset()
    places = body_at(0.05 * size[0], 0.1 * size[1], spacing=0.1 * min(size))
    body = found(model, picture(places, size=size, radius=0.03 * min(size)))
    assert body.xy.shape == (33, 2)
    error = np.linalg.norm(body.xy[COLUMNS] - places, axis=1).max()
    # The model's own pixels are up to twice the image's.
    assert error < 0.6 * max(1.0, max(size) / 640)
    assert body.visibility[COLUMNS].min() > 0.9
    assert 0.5 < body.score <= 1


def test_landmarks_that_coco_lacks_are_not_seen(model: YoloPose) -> None:
    model.reset()
    body = found(model, picture(body_at(30, 50)))
    assert np.isnan(body.xy[OTHERS]).all()
    assert (body.visibility[OTHERS] == 0).all()


def test_a_keypoint_that_is_hidden_is_not_seen_and_the_others_stay(model: YoloPose) -> None:
    model.reset()
    places = body_at(30, 50)
    places[COCO_17.index("right_wrist")] = np.nan
    body = found(model, picture(places))
    hidden = np.isnan(body.xy[COLUMNS]).any(axis=1)
    assert [COCO_17[index] for index in np.flatnonzero(hidden)] == ["right_wrist"]
    assert body.visibility[POSE_LANDMARKS.index("right_wrist")] == 0


def test_without_a_person_there_is_no_body(model: YoloPose) -> None:
    model.reset()
    assert model.track(picture(), 0.0).bodies == ()


def test_of_two_people_the_larger_one_is_followed_and_kept(small: YoloPose) -> None:
    small.reset()
    near, far = body_at(30, 50), body_at(420, 50, spacing=30)
    body = found(small, picture(near, far), 0.0)
    np.testing.assert_allclose(body.xy[COLUMNS], near, atol=1.5)
    body = found(small, picture(near, body_at(400, 30, spacing=60)), 0.1)
    np.testing.assert_allclose(body.xy[COLUMNS], near, atol=1.5)
    small.reset()
    body = found(small, picture(near, body_at(400, 30, spacing=60)), 0.2)
    np.testing.assert_allclose(body.xy[COLUMNS], body_at(400, 30, spacing=60), atol=1.5)


def test_what_is_no_image_is_refused(small: YoloPose) -> None:
    with pytest.raises(EstimatorError, match="expected"):
        small.track(np.zeros((4, 4), np.uint8), 0.0)


def test_a_model_of_something_else_is_told_by_the_shape_it_gives(tmp_path: Path) -> None:
    other = save_hand_keypoints(tmp_path / "hand.onnx")
    needed = r"gives \[\(1, 19\), \(1, 21, 48, 48\)\], needed: \(1, 56, N\) or.*\(1, N, 57\)"
    with pytest.raises(ModelError, match=needed):
        YoloPose(other)


@pytest.mark.parametrize("shape", [(1, 84, 8400), (1, 300, 6), (2, 56, 8400), (56, 8400)])
def test_detection_models_and_batches_are_refused_with_their_shape(shape: tuple[int, ...]) -> None:
    with pytest.raises(ModelError, match=str(shape).replace("(", r"\(").replace(")", r"\)")):
        decode_people([np.zeros(shape, np.float32)], Path("yolo11n.onnx"))


@pytest.mark.usefixtures("installed_models")
def test_a_model_that_takes_no_planes_is_told_by_the_shape_it_takes() -> None:
    from app.recognition.models.storage import model_path

    with pytest.raises(ModelError, match=r"takes \[\(\(1, 256, 256, 3\).*\(1, 3, height, width\)"):
        YoloPose(model_path("pose_landmark_full"))


def test_a_missing_file_and_one_that_is_no_model_are_named(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"no model file .*nowhere\.onnx"):
        YoloPose(tmp_path / "nowhere.onnx")
    (tmp_path / "text.onnx").write_text("no model")
    with pytest.raises(ModelError, match=r"text\.onnx cannot be loaded.*YOLO-pose"):
        YoloPose(tmp_path / "text.onnx")


def test_an_estimator_is_named_by_its_file(tmp_path: Path) -> None:
    path = save_yolo_pose(tmp_path / "markers-pose.onnx", side=320)
    estimator = create_estimator(f"yolo-pose:{path}", hands="none")
    places = body_at(30, 50)
    seen = estimator.estimate(picture(places), 0.0)
    assert seen.body is not None
    np.testing.assert_allclose(seen.body.xy[COLUMNS], places, atol=1.5)
    assert seen.hands == ()
    assert list_landmarks(estimator) == COCO_17
    assert not finds_hands(estimator)
    estimator.reset()
    estimator.close()


@pytest.mark.usefixtures("installed_models")
def test_beside_it_the_installed_models_look_for_hands(tmp_path: Path) -> None:
    path = save_yolo_pose(tmp_path / "markers-pose.onnx", side=320)
    estimator = create_estimator(f"yolo-pose:{path}")
    assert finds_hands(estimator)
    assert estimator.estimate(picture(body_at(30, 50)), 0.0).hands == ()
    estimator.close()


def test_a_body_tells_the_paper_s_hands_their_side(tmp_path: Path) -> None:
    path = save_yolo_pose(tmp_path / "markers-pose.onnx", side=320)
    pair = save_hand_detector(tmp_path / "d.onnx"), save_hand_keypoints(tmp_path / "k.onnx")
    estimator = create_estimator(f"yolo-pose:{path}", hands=f"{pair[0]},{pair[1]}")
    assert finds_hands(estimator)
    # To the marker models a body is a hand as well: its colours are some of the hand's.
    seen = estimator.estimate(picture(body_at(30, 50)), 0.0)
    assert seen.body is not None
    (hand,) = seen.hands
    wrists = {
        side: np.linalg.norm(seen.body.xy[POSE_LANDMARKS.index(f"{side}_wrist")] - hand.xy[0])
        for side in ("left", "right")
    }
    assert hand.side == min(wrists, key=lambda side: wrists[side])
    estimator.close()


def test_an_examination_finds_who_is_most_prominent_and_follows_the_one_before(
    small: YoloPose,
) -> None:
    small.reset()
    near, larger = body_at(30, 50), body_at(400, 30, spacing=60)
    found(small, picture(near))
    examined = small.examine(picture(near, larger)).body
    assert examined is not None
    np.testing.assert_allclose(examined.xy[COLUMNS], larger, atol=1.5)
    again = found(small, picture(near, larger), 0.1)
    np.testing.assert_allclose(again.xy[COLUMNS], near, atol=1.5)


def test_it_is_asked_for_the_correction_of_the_water(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = save_yolo_pose(tmp_path_factory.mktemp("asked") / "markers.onnx", side=320)
    estimator = create_estimator(f"yolo-pose:{path}", hands="none")
    assert isinstance(estimator, Examiner)
    seen = estimator.examine(picture(body_at(100, 60)))
    assert seen.body is not None
    assert seen.hands == ()
