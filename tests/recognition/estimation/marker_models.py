"""ONNX models that find coloured markers, with the shapes of the real models they stand for.

The weights of YOLO-pose and of the paper's hand models are not part of this project. These graphs
compute their answers from the image by ONNX operators alone: what comes out right went through the
real letterbox, the real runtime, the real decoding and the real way back to the image.
"""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import onnx
from onnx import TensorProto, helper, numpy_helper

from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import COCO_17

COLOURS = tuple(
    colour for colour in product((0, 85, 170, 255), repeat=3) if max(colour) == 255 > min(colour)
)
"""RGB, one per marker. A marker fades at its edge, and no colour is another one faded."""

BODY_COLOURS = COLOURS[: len(COCO_17)]
HAND_COLOURS = COLOURS[: len(HAND_LANDMARKS)]

TOLERANCE = 0.08
"""Tolerance of a channel in [0, 1]: a quarter of the distance between two colours."""

ENOUGH = 20.0
"""Number of a marker's pixels from which its score is 1."""


def draw_markers(
    image: Image, places: FloatArray, colours: tuple[tuple[int, ...], ...], radius: float
) -> None:
    """Draw a marker at each of the places ``(K, 2)``, pixels, to a sixteenth; NaN: none."""
    for place, colour in zip(places, colours, strict=True):
        if np.isfinite(place).all():
            # OpenCV counts from the middle of the first pixel, landmarks from its corner.
            centre = np.round((place - 0.5) * 16).astype(int).tolist()
            cv2.circle(image, centre, round(radius * 16), colour, -1, cv2.LINE_AA, shift=4)


class _Graph:
    """Nodes and constants of a model, with generated names."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []

    def constant(self, values: npt.ArrayLike, kind: type = np.float32) -> str:
        name = f"constant{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.asarray(values, dtype=kind), name))
        return name

    def add(self, operator: str, *inputs: str, output: str = "", **attributes: Any) -> str:
        name = output or f"{operator}{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, list(inputs), [name], **attributes))
        return name

    def total(self, values: str, axes: list[int]) -> str:
        return self.add("ReduceSum", values, self.constant(axes, np.int64), keepdims=0)

    def masks(self, image: str, colours: tuple[tuple[int, ...], ...]) -> str:
        """``(K, 1, height, width)`` 1 where the image has a colour."""
        wanted = self.constant(np.array(colours)[:, :, None, None] / 255)
        off = self.add("Abs", self.add("Sub", image, wanted))
        farthest = self.add("ReduceMax", off, axes=[1], keepdims=1)
        near = self.add("Less", farthest, self.constant(TOLERANCE))
        return self.add("Cast", near, to=TensorProto.FLOAT)

    def save(self, path: Path, side: int, outputs: dict[str, list[int | str]]) -> Path:
        taken = helper.make_tensor_value_info("images", TensorProto.FLOAT, [1, 3, side, side])
        given = [
            helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
            for name, shape in outputs.items()
        ]
        graph = helper.make_graph(self.nodes, "markers", [taken], given, self.constants)
        onnx.save(
            helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8),
            path,
        )
        return path


def save_yolo_pose(path: Path, *, side: int = 640, suppressed: bool = False) -> Path:
    """Write a model that finds a body of markers in each half of its input, left and right.

    Each is found four times, with falling scores, in boxes two pixels apart and with keypoints that
    err by 30 pixels in all but the best, so that missing suppression gives large errors.

    Parameters
    ----------
    side
        Pixels of the input.
    suppressed
        Whether to give final detections, ``(1, 300, 57)``, in place of ``(1, 56, N)`` candidates.

    """
    graph = _Graph()
    columns = np.arange(side) + 0.5
    halves = np.stack([columns < side / 2, columns >= side / 2])
    found = graph.add(
        "Mul", graph.masks("images", BODY_COLOURS), graph.constant(halves[None, :, None])
    )
    count = graph.total(found, [2, 3])
    least = graph.add("Max", count, graph.constant(1.0))
    x, y = (
        graph.add("Div", graph.total(graph.add("Mul", found, graph.constant(at)), [2, 3]), least)
        for at in (columns[None, None, None], columns[None, None, :, None])
    )
    visible = graph.add("Min", graph.add("Div", count, graph.constant(ENOUGH)), graph.constant(1.0))
    low, high = _box(graph, x, y, visible)
    score = graph.add("ReduceMean", visible, axes=[0], keepdims=1)
    keypoints = graph.add(
        "Reshape",
        graph.add(
            "Concat",
            *(
                graph.add("Unsqueeze", one, graph.constant([1], np.int64))
                for one in (x, y, visible)
            ),
            axis=1,
        ),
        graph.constant([3 * len(COCO_17), 2], np.int64),
    )
    if suppressed:
        kind = graph.add("Mul", score, graph.constant(0.0))
        people = graph.add("Concat", low, high, score, kind, keypoints, axis=0)
        rows = graph.add(
            "MatMul", graph.constant(np.eye(300, 2)), graph.add("Transpose", people, perm=[1, 0])
        )
        graph.add("Unsqueeze", rows, graph.constant([0], np.int64), output="output0")
        return graph.save(path, side, {"output0": [1, 300, 57]})
    middle = graph.add("Mul", graph.add("Add", low, high), graph.constant(0.5))
    extent = graph.add("Sub", high, low)
    people = graph.add("Concat", middle, extent, score, keypoints, axis=0)
    anchors = sum((side // stride) ** 2 for stride in (8, 16, 32))
    spread = np.zeros((2, anchors))
    spread[0, :4] = spread[1, -4:] = 1
    scale, error = np.ones((56, anchors)), np.zeros((56, anchors))
    for place in (0, anchors - 4):
        scale[4, place : place + 4] = (0.7, 0.8, 0.95, 0.6)
        error[0, place : place + 4] = (2, -2, 0, 1)
        error[5::3, place : place + 4] = (30, -30, 0, 30)
    candidates = graph.add("MatMul", people, graph.constant(spread))
    erring = graph.add(
        "Add", graph.add("Mul", candidates, graph.constant(scale)), graph.constant(error)
    )
    graph.add("Unsqueeze", erring, graph.constant([0], np.int64), output="output0")
    return graph.save(path, side, {"output0": [1, 56, anchors]})


def _box(graph: _Graph, x: str, y: str, visible: str) -> tuple[str, str]:
    """``(2, people)`` corners around the visible keypoints, ten pixels away from them."""
    seen = graph.add("Greater", visible, graph.constant(0.5))
    beyond = {"ReduceMin": 1e4, "ReduceMax": -1e4}
    corners = []
    for operator, margin in (("ReduceMin", -10.0), ("ReduceMax", 10.0)):
        ends = [
            graph.add(
                operator,
                graph.add("Where", seen, one, graph.constant(beyond[operator])),
                axes=[0],
                keepdims=1,
            )
            for one in (x, y)
        ]
        joined = graph.add("Concat", *ends, axis=0)
        corners.append(graph.add("Add", joined, graph.constant(margin)))
    return corners[0], corners[1]


def save_hand_detector(path: Path, *, side: int = 416) -> Path:
    """Write a model that gives one ``(1, 7)`` row around all that is bright, or none."""
    graph = _Graph()
    brightest = graph.add("ReduceMax", "images", axes=[1], keepdims=1)
    bright = graph.add(
        "Cast", graph.add("Greater", brightest, graph.constant(0.9)), to=TensorProto.FLOAT
    )
    ends = []
    for at in (np.arange(side)[None, None, None], np.arange(side)[None, None, :, None]):
        after = graph.add("Mul", bright, graph.constant(at + 1))
        before = graph.add("Mul", bright, graph.constant(side - at))
        last = graph.add("ReduceMax", after, axes=[2, 3], keepdims=0)
        first = graph.add("ReduceMax", before, axes=[2, 3], keepdims=0)
        ends.append((graph.add("Sub", graph.constant(float(side)), first), last))
    (left, right), (top, bottom) = ends
    score = graph.add("ReduceMax", bright, axes=[2, 3], keepdims=0)
    zero = graph.add("Mul", score, graph.constant(0.0))
    row = graph.add("Concat", zero, left, top, right, bottom, zero, score, axis=1)
    there = graph.add(
        "Greater", graph.add("Squeeze", score, graph.constant([1], np.int64)), graph.constant(0.5)
    )
    graph.add("Compress", row, there, axis=0, output="output")
    return graph.save(path, side, {"output": ["hands", 7]})


def save_hand_keypoints(path: Path, *, side: int = 192, cells: int = 48) -> Path:
    """Write a model that gives ``(1, 19)`` labels and ``(1, 21, 48, 48)`` heat maps of markers.

    It takes what the real one takes: BGR, with ImageNet's mean and deviation taken out of values in
    0 to 255 before they are divided by 255.
    """
    graph = _Graph()
    deviation = np.array([0.229, 0.224, 0.225])[None, :, None, None]
    mean = np.array([0.485, 0.456, 0.406])[None, :, None, None] / 255
    bgr = graph.add(
        "Add",
        graph.add("Mul", "images", graph.constant(deviation)),
        graph.constant(mean),
    )
    rgb = graph.add("Gather", bgr, graph.constant([2, 1, 0], np.int64), axis=1)
    masks = graph.add("Transpose", graph.masks(rgb, HAND_COLOURS), perm=[1, 0, 2, 3])
    step = side // cells
    # A cell looks at twice its size around its own corner, as maps are trained.
    smooth = graph.add(
        "AveragePool",
        masks,
        kernel_shape=[2 * step, 2 * step],
        strides=[step, step],
        pads=[step, step, 0, 0],
        count_include_pad=1,
    )
    labels = graph.add("ReduceMean", smooth, axes=[2, 3], keepdims=0)
    graph.add("Gather", labels, graph.constant(np.arange(19), np.int64), axis=1, output="labels")
    graph.add("Identity", smooth, output="heatmaps")
    return graph.save(
        path, side, {"labels": [1, 19], "heatmaps": [1, len(HAND_LANDMARKS), cells, cells]}
    )
