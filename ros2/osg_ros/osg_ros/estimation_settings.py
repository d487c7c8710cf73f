"""Parameters of the nodes that look at pictures."""

from __future__ import annotations

from typing import Final, get_args

from app.recognition.estimation import Provider
from app.recognition.estimation.water import WaterCorrection
from osg_ros.settings import Setting

WATER: Final = Setting(
    "water",
    "auto",
    "Correct colour and contrast under water: of murky pictures, of all, or of none.",
    choices=get_args(WaterCorrection),
)
THREADS: Final = Setting(
    "threads", 2, "Processor threads for the models; two run body and hands side by side.", 1, 64
)
PROVIDER: Final = Setting(
    "provider", "cpu", "Where ONNX Runtime runs the models.", choices=get_args(Provider)
)
