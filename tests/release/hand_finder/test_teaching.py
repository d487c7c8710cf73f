"""Teaching: crops, and a network that is written back as the file it came from."""

from pathlib import Path

import numpy as np
import pytest

from app.recognition.models.storage import ModelName, model_path
from release.hand_finder.pictures import Hands, Picture
from tests.recognition.estimation.drawn_hand import flat_hand

torch = pytest.importorskip("torch", reason="PyTorch teaches the finder only; it is in no lock")


@pytest.fixture
def picture() -> Picture:
    """Return a grey picture with one hand known in full, and one of which only the box is."""
    nan = float("nan")
    hands = np.array(
        [[100.0, 100, 160, 160, 110, 150, 140, 120], [400, 300, 460, 360, nan, nan, nan, nan]]
    )
    return Picture(np.full((480, 640, 3), 90, np.uint8), hands, np.empty((0, 8)))


def test_crops_teach_the_places_of_hands(picture: Picture) -> None:
    from release.hand_finder.teaching import draw_crop

    random = np.random.default_rng(0)
    targets = [draw_crop([picture], random)[1] for _ in range(30)]
    assert any(target.score.any() for target in targets)
    for target in targets:
        taught = target.score > 0
        assert np.isfinite(target.places[taught, :4]).all()
        assert (target.weight[taught] == 1).all()
        assert np.isnan(target.places[~taught]).all()


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize(
    ("name", "side"), [("palm_detection_full", 192), ("hand_landmark_full", 224)]
)
def test_an_untaught_network_says_what_its_model_says(
    tmp_path: Path, name: ModelName, side: int
) -> None:
    import onnxruntime  # type: ignore[import-untyped]

    from release.hand_finder.network import TaughtNetwork

    network = TaughtNetwork(model_path(name))
    network.write(tmp_path / "same.onnx")
    image = np.random.default_rng(0).random((1, side, side, 3)).astype(np.float32)
    session = onnxruntime.InferenceSession(str(tmp_path / "same.onnx"))
    expected = session.run(None, {session.get_inputs()[0].name: image})
    for said, meant in zip(network(torch.tensor(image)), expected, strict=True):
        assert said.detach().numpy() == pytest.approx(meant, rel=1e-3, abs=1e-2)


def test_crops_of_hands_know_their_joints_and_others_show_none() -> None:
    from release.hand_finder.landmarks import draw_hand, draw_other

    joints = np.array([flat_hand() + (200, 300), flat_hand() + (450, 300)])
    white = np.zeros((480, 640, 3), np.uint8)
    for x, y in joints.reshape(-1, 2).round().astype(int):
        white[y - 3 : y + 4, x - 3 : x + 4] = 255
    still, random = Hands(white, joints, np.ones(2)), np.random.default_rng(0)
    for _ in range(10):
        crop, points, right = draw_hand([still], random)
        places = points.round().astype(int).clip(0, 223)
        assert right in (0.0, 1.0)
        assert (crop[places[:, 1], places[:, 0]].mean() > crop.mean()).all()
        assert draw_other([still], random).shape == (224, 224, 3)
