"""Upload fields: a sender's values for a file, from form fields or tus metadata."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from app.api.http.problems import Fault, ProblemError
from app.clip_sources import ReadOptions
from app.recognition.text.described import DESCRIBED

LONGEST_TOPIC: Final = 255
"""Most bytes of a topic's name, as ROS allows."""

_LONGEST_NUMBER: Final = 32
"""Most bytes of a rate or a size: more digits than any needs."""

LONGEST: Final[Mapping[str, int]] = {
    "topic": LONGEST_TOPIC,
    "frame_rate": _LONGEST_NUMBER,
    "frame_size": _LONGEST_NUMBER,
    "chapters": 512,
}
"""Most bytes of each field, by name."""

FASTEST: Final = 1000.0
"""Highest frame rate accepted, in frames per second: no underwater camera takes more."""

Size = Annotated[str, StringConstraints(pattern=r"^[1-9]\d{0,4}\s*[xX]\s*[1-9]\d{0,4}$")]

"""Width and height in pixels, as ``1920x1080``."""

Sizes = Annotated[str, StringConstraints(pattern=r"^[1-9]\d{0,14}(,[1-9]\d{0,14}){1,63}$")]
"""Bytes of each of several files, as ``4000000,120000``."""


class UploadFields(BaseModel):
    """The fields of one upload; each is None where it is absent or empty."""

    model_config = ConfigDict(**DESCRIBED, extra="forbid", str_strip_whitespace=True)

    topic: str | None = None
    """Of a dive recording with several topics: which one."""
    frame_rate: Annotated[float, Field(gt=0, le=FASTEST)] | None = None
    """Of a keypoint file that counts frames: its video's, a second."""
    frame_size: Size | None = None
    """Of a keypoint file with fractions of the picture: pixels, as 1920x1080."""

    chapters: Sizes | None = None
    """Of a camera's chapters of one recording, sent one after the other as one file: the bytes of
    each, as 4000000,120000. They become one video, without its sound."""

    @classmethod
    def read(cls, texts: Mapping[str, str]) -> UploadFields:
        """Parse the fields; unknown ones are ignored, as both protocols require.

        Raises
        ------
        ProblemError
            422 when a value is malformed.

        """
        given = {name: texts[name] for name in LONGEST if texts.get(name, "").strip()}
        try:
            return cls.model_validate(given)
        except ValidationError as error:
            faults = [
                Fault(pointer="", parameter=str(fault["loc"][0]), detail=fault["msg"])
                for fault in error.errors(include_url=False)
            ]
            detail = "; ".join(f"the field {fault.parameter}: {fault.detail}" for fault in faults)
            raise ProblemError(422, "field_invalid", detail, errors=faults) from error

    @property
    def options(self) -> ReadOptions:
        """Return how the file is read."""
        size = None
        if self.frame_size is not None:
            width, height = self.frame_size.lower().split("x")
            size = int(width), int(height)
        chapters = tuple(map(int, self.chapters.split(","))) if self.chapters else ()
        return ReadOptions(
            topic=self.topic, frame_rate=self.frame_rate, frame_size=size, chapters=chapters
        )
