"""Estimator options: the command-line options that select the body and hand estimators."""

from __future__ import annotations

from typing import Annotated

import typer

from app.recognition.estimation.water import WaterCorrection

WaterOption = Annotated[
    WaterCorrection,
    typer.Option(help="Correct colour and contrast: as the models see most, always, or never."),
]

EstimatorOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Finds the body: onnx, mediapipe, or yolo-pose:FILE.onnx, an Ultralytics export.",
    ),
]

HandsOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Finds the hands: mediapipe, none, or DETECTOR.onnx,KEYPOINTS.onnx, the paper's pair.",
    ),
]
