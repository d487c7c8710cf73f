"""Responses with the trajectory image of a gesture or of one of its demonstrations."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, Response

from app.api.http.problems import file_responses
from app.recognition import Gesture
from app.recognition.features.png import encode_png
from app.ui.charts import mark_gesture, png

IMAGE_RESPONSES = file_responses("The trajectory image", "image/png")

Marks = Annotated[bool, Query(description="With start dot and arrow, for people")]


def draw_trajectory_image(gesture: Gesture, marks: bool) -> bytes:
    """Return a gesture's trajectory image as PNG."""
    return png(mark_gesture(gesture)) if marks else encode_png(gesture.image)


def send_trajectory_image(gesture: Gesture, revision: int | None, marks: bool) -> Response:
    """Return a gesture's trajectory image as PNG; `revision` is the requested one, if any."""
    image = draw_trajectory_image(gesture, marks)
    # A revision never changes, so its pictures can be kept.
    headers = {"Cache-Control": "private, max-age=86400"} if revision is not None else {}
    return Response(image, media_type="image/png", headers=headers)
