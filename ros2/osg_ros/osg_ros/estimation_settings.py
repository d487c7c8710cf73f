"""Estimation settings: parameters of the nodes that process pictures."""

from __future__ import annotations

from typing import Final, get_args

from app.recognition.estimation.factory import MEDIAPIPE_HANDS
from app.recognition.estimation.landmark_models.onnx_session import Provider
from app.recognition.estimation.water import WaterCorrection
from osg_ros.parameters import Setting

WATER: Final = Setting(
    "water",
    "auto",
    "Correct colour and contrast under water: as the models see most, of all pictures, or of none.",
    choices=get_args(WaterCorrection),
)
THREADS: Final = Setting(
    "threads", 2, "Processor threads for the models; two run body and hands side by side.", 1, 64
)
PROVIDER: Final = Setting(
    "provider", "cpu", "Execution provider of ONNX Runtime.", choices=get_args(Provider)
)
ESTIMATOR: Final = Setting(
    "estimator",
    "onnx",
    "Finds the body: onnx, mediapipe, or yolo-pose:FILE.onnx, an Ultralytics export.",
)
HANDS: Final = Setting(
    "hands",
    MEDIAPIPE_HANDS,
    "Finds the hands: mediapipe, none, or DETECTOR.onnx,KEYPOINTS.onnx, the paper's pair.",
)
