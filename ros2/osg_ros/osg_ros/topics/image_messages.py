"""Image messages: convert `sensor_msgs` pictures to RGB images and back, without cv_bridge."""

from __future__ import annotations

from typing import Final

from av.error import FFmpegError
from sensor_msgs.msg import CompressedImage, Image

from app.bags.image_messages import PacketDecoder, raw_image
from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image as RGBImage
from app.recognition.recording.video_limits import VideoLimits
from osg_ros.parameters import Setting

TRANSPORT: Final = Setting(
    "image_transport",
    "raw",
    "Form of the pictures: raw on `image`, or compressed (JPEG, PNG) on `image/compressed`.",
    choices=("raw", "compressed"),
)


def select_image_topic(transport: str) -> tuple[type[Image] | type[CompressedImage], str]:
    """Select the type and the relative name of the topic of pictures.

    Parameters
    ----------
    transport
        A choice of `TRANSPORT`.

    """
    return (Image, "image") if transport == "raw" else (CompressedImage, "image/compressed")


class PictureDecoder:
    """Decoder of the pictures of one topic."""

    def __init__(self) -> None:
        self._limits = VideoLimits()
        self._packets = PacketDecoder(self._limits)

    def decode(self, message: Image | CompressedImage) -> RGBImage:
        """Decode the picture of a message.

        Returns
        -------
        ``(height, width, 3)`` RGB.

        Raises
        ------
        OsgError
            When the encoding is not known, the data is damaged, or the picture is too large.

        """
        if isinstance(message, Image):
            return raw_image(message, self._limits)
        try:
            images = [
                image for _, image in self._packets.decode(bytes(message.data), message.format, 0)
            ]
        except FFmpegError as error:
            raise VideoError(f"a compressed picture is damaged: {error.strerror}") from error
        if not images:
            raise VideoError(f"a message of {len(message.data)} bytes holds no picture")
        return images[-1]


def to_image_message(image: RGBImage) -> Image:
    """Convert an RGB image to a message; the caller sets its header."""
    height, width, channels = image.shape
    return Image(
        height=height,
        width=width,
        encoding="rgb8",
        step=width * channels,
        data=image.tobytes(),
    )
