"""Pose and hand landmarks from images: one protocol, several backends."""

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import (
    Backend,
    create_estimator,
    finds_hands,
    list_landmarks,
)
from app.recognition.estimation.landmark_models.onnx_session import Provider, available_providers
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.onnx_estimator import OnnxPoseEstimator
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image, Side

__all__ = [
    "Backend",
    "Body",
    "FrameLandmarks",
    "Hand",
    "Image",
    "MediaPipeEstimator",
    "OnnxPoseEstimator",
    "PoseEstimator",
    "Provider",
    "Side",
    "available_providers",
    "create_estimator",
    "finds_hands",
    "list_landmarks",
]
