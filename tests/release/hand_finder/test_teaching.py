"""Teaching: crops, and a network that is written back as the file it came from."""

from pathlib import Path

import numpy as np
import pytest

from app.recognition.models import model_path
from release.hand_finder.pictures import Picture

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
def test_an_untaught_network_says_what_the_detector_says(tmp_path: Path) -> None:
    import onnxruntime  # type: ignore[import-untyped]

    from release.hand_finder.network import TaughtNetwork

    path = model_path("palm_detection_full")
    network = TaughtNetwork(path)
    network.write(tmp_path / "same.onnx")
    image = np.random.default_rng(0).random((1, 192, 192, 3)).astype(np.float32)
    session = onnxruntime.InferenceSession(str(tmp_path / "same.onnx"))
    expected = session.run(None, {session.get_inputs()[0].name: image})
    for said, meant in zip(network(torch.tensor(image)), expected, strict=True):
        assert said.detach().numpy() == pytest.approx(meant, abs=1e-3)
