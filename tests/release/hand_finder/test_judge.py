"""Judge: looks at pictures become weights, and the model says what the weights say."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from app.recognition.models.storage import gloves_path

pytest.importorskip("torch", reason="PyTorch teaches the judge only; it is in no lock")

PICTURES = Path(__file__).parents[2] / "recognition" / "estimation"
BOXES = """image,what,x0,y0,x1,y1,wrist_x,wrist_y,knuckle_x,knuckle_y
gloved_diver.jpg,Hand,452,344,520,390
gloved_diver.jpg,Hand,322,154,352,193
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a rendered diver whose two hands are boxed."""
    (tmp_path / "images").mkdir()
    shutil.copy(PICTURES / "gloved_diver.jpg", tmp_path / "images")
    (tmp_path / "boxes.csv").write_text(BOXES)
    return tmp_path


def test_the_feature_that_tells_hands_is_learnt() -> None:
    from release.hand_finder.judge import fit

    random = np.random.default_rng(0)
    features = random.normal(size=(2000, 3)).astype(np.float32) * (1, 5, 1) + (0, 2, 0)
    hands = features[:, 1] > 2
    weights, bias = fit(features.astype(np.float32), hands)
    judged = features @ weights + bias
    assert np.mean((judged > 0) == hands) > 0.97
    assert abs(5 * weights[1]) > 5 * max(abs(weights[0]), abs(weights[2]))


@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_a_taught_model_judges_as_its_weights_and_sees_as_before(
    folder: Path, tmp_path: Path
) -> None:
    import onnxruntime  # type: ignore[import-untyped]

    from release.hand_finder.judge import _open_features, fit, teach_judgement, write_looks

    model = gloves_path()
    assert model is not None
    write_looks(folder, model, seed=0)
    with np.load(folder / "looks.npz") as looks:
        features, hands = looks["features"].astype(np.float32), looks["hands"]
    assert hands.any()
    taught = tmp_path / "taught.onnx"
    teach_judgement(model, [folder], taught)
    weights, bias = fit(features, hands)
    image = np.random.default_rng(0).random((1, 224, 224, 3)).astype(np.float32)
    before, source = _open_features(model)
    given = {before.get_inputs()[0].name: image}
    (seen,) = before.run([source], given)
    after = onnxruntime.InferenceSession(str(taught))
    *outputs, judged = after.run(None, given)
    assert judged.item() == pytest.approx(seen.reshape(-1) @ weights + bias, abs=0.02)
    for one, other in zip(outputs, before.run(None, given), strict=False):
        assert one == pytest.approx(other)
