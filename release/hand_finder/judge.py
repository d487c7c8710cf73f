"""Judge: the model of gloved hands learns to tell whether what a landmark model sees is a hand.

Its presence was taught with crops beside hands, and believes in nearly all that is taken for one.
`write_looks` keeps what both landmark models see at the finder's places in pictures with boxed
hands, or without any, as the features from which presence is told. `teach_judgement` teaches a
further output, 1,153 weights, which of them are hands; the others stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import onnx
import onnxruntime  # type: ignore[import-untyped]
import torch
from onnx import TensorProto, helper, numpy_helper

from app.recognition.estimation.factory import hand_tracker
from app.recognition.estimation.landmark_models.hand_model import (
    INPUT_SIZE,
    LEAST_PRESENCE,
    WORTH_A_SECOND_LOOK,
    HandModel,
    HandPlace,
    SeenHand,
    parts_of,
)
from app.recognition.estimation.landmark_models.hand_tracker import (
    FINGERS_SCALE,
    GLOVE_SCALE,
    TURNS,
)
from app.recognition.estimation.landmark_models.region import REPLICATED_BORDER
from app.recognition.estimation.water import CORRECTIONS, apply_correction
from app.recognition.poses.frame import Image
from release.hand_finder.pictures import read_boxes, read_rgb

PRESENCE: Final = "Identity_1"
"""Output of a hand landmark model that tells whether there is a hand."""

JUDGEMENT: Final = "judgement"
"""The output that is taught."""

PROPOSED_FROM, PLACES = 0.2, 5
"""Least score of the finder's places that are looked at, and their number in a picture."""

LOOKS = 3
"""Number of `TURNS` in which a place is looked at."""

SCALES: Final = {False: FINGERS_SCALE, True: GLOVE_SCALE}
"""Side of the region of a look, bare and gloved, over that of the place."""

SEEN_FROM: Final = {False: WORTH_A_SECOND_LOOK, True: LEAST_PRESENCE}
"""Presence from which a look has seen something."""

FITTING: Final = (0.45, 2.2)
"""Extents of a hand over its box's, between which it is that hand."""

STRENGTH: Final = 0.64
"""Of the penalty on squared weights, for features of deviation 1, beside the mean loss."""

Hands = npt.NDArray[np.bool_]
Features = npt.NDArray[np.float32]
Boxes = dict[str, npt.NDArray[np.float64]]


def write_looks(folder: Path, model: Path, seed: int) -> None:
    """Keep what landmark models see in the pictures of a folder beside them, in `looks.npz`.

    Its arrays are the features ``(N, 1152)`` of the model of gloved hands, and whether each is a
    hand, ``(N,)``. What is partly a hand, or of another size, is left out.
    """
    random = np.random.default_rng(seed)
    tracker = hand_tracker(search="pose", threads=1, provider="cpu")
    session, source = _open_features(model)
    rows: list[Features] = []
    hands: list[bool] = []
    for name, kinds in read_boxes(folder).items():
        correction = CORRECTIONS[random.integers(len(CORRECTIONS))]
        image = apply_correction(read_rgb(folder / "images" / name), correction)
        assert tracker.finder is not None
        places = tracker.finder.search(image, parts_of(image), PROPOSED_FROM)[:PLACES]
        for one in _distinct(_look(tracker.model, image, places, int(random.integers(TURNS)))):
            what = _tell(one, kinds)
            if what is not None:
                pixels = one.following.crop(image, INPUT_SIZE, REPLICATED_BORDER)
                given = {session.get_inputs()[0].name: pixels[None].astype(np.float32) / 255}
                rows.append(session.run([source], given)[0].reshape(-1))
                hands.append(what)
    np.savez(folder / "looks.npz", features=np.array(rows, np.float16), hands=np.array(hands))


def _open_features(model: Path) -> tuple[Any, str]:
    """Open a landmark model with the features of its presence as a further output; name them."""
    loaded = onnx.load(str(model))
    source = _find_features(loaded.graph)
    loaded.graph.output.append(helper.make_empty_tensor_value_info(source))
    return onnxruntime.InferenceSession(loaded.SerializeToString()), source


def _find_features(graph: onnx.GraphProto) -> str:
    """Return the name of the features from which presence is told."""
    made = {node.output[0]: node for node in graph.node}
    node = made[PRESENCE]
    while node.op_type != "Gemm":
        node = made[node.input[0]]
    return str(node.input[0])


def _look(
    model: HandModel, image: Image, places: Iterable[HandPlace], turn: int
) -> Iterator[SeenHand]:
    """Yield what both models see at places, in some turns, at the second look."""
    for place in places:
        for step in range(LOOKS):
            rotation = place.box.rotation + (turn + 3 * step) * 2 * np.pi / TURNS
            for gloved, scale in SCALES.items():
                region = replace(place.box, side=scale * place.box.side, rotation=rotation)
                seen = model.see_twice(image, region, gloved=gloved, least=SEEN_FROM[gloved])
                if seen is not None:
                    yield seen


def _distinct(looks: Iterable[SeenHand]) -> list[SeenHand]:
    """Return what was seen, best first, without what lies at the place of a better one."""
    kept: list[SeenHand] = []
    for one in sorted(looks, key=lambda one: -one.hand.score):
        middle, side = one.hand.xy.mean(axis=0), one.hand.size
        if all(np.linalg.norm(other.hand.xy.mean(axis=0) - middle) > side / 4 for other in kept):
            kept.append(one)
    return kept


def _tell(one: SeenHand, kinds: Boxes) -> bool | None:
    """Return whether a hand is in the box of one; None where it is unclear."""
    low, high = one.hand.xy.min(axis=0), one.hand.xy.max(axis=0)
    middle, extent = (low + high) / 2, 4 / 3 * (high - low).max()
    told: bool | None = False
    for kind, boxes in kinds.items():
        for start, end in boxes[:, :4].reshape(-1, 2, 2):
            if (start <= middle).all() and (middle <= end).all():
                fits = FITTING[0] < extent / (end - start).max() < FITTING[1]
                if kind == "Hand" and fits:
                    return True
                told = None
    return told


def teach_judgement(model: Path, folders: Sequence[Path], output: Path) -> None:
    """Teach the judgement by the looks of folders, and write the model with it as ONNX.

    It is a logistic regression, with a penalty of `STRENGTH`; nothing is random.
    """
    kept = [np.load(folder / "looks.npz") for folder in folders]
    features = np.concatenate([each["features"] for each in kept]).astype(np.float32)
    hands = np.concatenate([each["hands"] for each in kept])
    print(f"{len(hands)} looks, {hands.sum()} of them at hands", flush=True)
    weights, bias = fit(features, hands)
    loaded = onnx.load(str(model))
    graph = loaded.graph
    values = {"judged": weights[None], "judged_bias": np.array([bias])}
    if all(output.name != JUDGEMENT for output in graph.output):
        for name in values:
            cast = helper.make_node("Cast", [name], [f"cast_{name}"], to=TensorProto.FLOAT)
            graph.node.append(cast)
        given = [_find_features(graph), *(f"cast_{name}" for name in values)]
        graph.node.append(helper.make_node("Gemm", given, [JUDGEMENT], transB=1))
        graph.output.append(helper.make_tensor_value_info(JUDGEMENT, TensorProto.FLOAT, (1, 1)))
    for tensor in [each for each in graph.initializer if each.name in values]:
        graph.initializer.remove(tensor)
    graph.initializer.extend(
        numpy_helper.from_array(each.astype(np.float16), name) for name, each in values.items()
    )
    onnx.checker.check_model(loaded)
    output.write_bytes(loaded.SerializeToString(deterministic=True))


def fit(features: Features, hands: Hands) -> tuple[npt.NDArray[np.float64], float]:
    """Return the weights ``(K,)`` and the bias of the logarithm of the odds of a hand."""
    mean, deviation = features.mean(axis=0), features.std(axis=0) + 1e-6
    given = torch.tensor((features - mean) / deviation, dtype=torch.float64)
    meant = torch.tensor(hands, dtype=torch.float64)
    weights = torch.zeros(given.shape[1], dtype=torch.float64, requires_grad=True)
    bias = torch.zeros((), dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.LBFGS([weights, bias], max_iter=200, line_search_fn="strong_wolfe")

    def measure() -> torch.Tensor:
        optimiser.zero_grad()
        odds = given @ weights + bias
        loss = torch.nn.functional.binary_cross_entropy_with_logits(odds, meant)
        loss = loss + STRENGTH / 2 * (weights**2).sum()
        loss.backward()
        return loss

    optimiser.step(measure)
    raw = weights.detach().numpy() / deviation
    return raw, float(bias.detach()) - float(raw @ mean)
