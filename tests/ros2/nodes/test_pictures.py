"""Pictures of every usual encoding come out as RGB, and others are refused by name."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from sensor_msgs.msg import CompressedImage, Image

from app.recognition import OsgError
from app.recognition.poses.frame import Image as RGBImage
from osg_ros.topics.image_messages import PictureDecoder, to_image_message


def picture() -> RGBImage:
    """Return 6 x 8 pixels, red on the left and blue on the right."""
    image = np.zeros((6, 8, 3), dtype=np.uint8)
    image[:, :4, 0] = 200
    image[:, 4:, 2] = 200
    return image


def message_of(data: RGBImage, encoding: str, step: int) -> Image:
    height, width = data.shape[:2]
    return Image(height=height, width=width, encoding=encoding, step=step, data=data.tobytes())


def test_what_is_sent_is_read_back() -> None:
    assert np.array_equal(PictureDecoder().decode(to_image_message(picture())), picture())


@pytest.mark.parametrize(
    ("encoding", "conversion"),
    [("bgr8", cv2.COLOR_RGB2BGR), ("bgra8", cv2.COLOR_RGB2BGRA), ("rgba8", cv2.COLOR_RGB2RGBA)],
)
def test_the_order_of_the_channels_is_put_right(encoding: str, conversion: int) -> None:
    data = np.asarray(cv2.cvtColor(picture(), conversion), dtype=np.uint8)
    decoded = PictureDecoder().decode(message_of(data, encoding, data.strides[0]))
    assert np.array_equal(decoded, picture())


def test_the_padding_of_rows_is_left_out() -> None:
    padded = np.zeros((6, 40), dtype=np.uint8)
    padded[:, :24] = picture().reshape(6, 24)
    message = Image(height=6, width=8, encoding="rgb8", step=40, data=padded.tobytes())
    assert np.array_equal(PictureDecoder().decode(message), picture())


@pytest.mark.parametrize("ending", [".png", ".jpg"])
def test_compressed_pictures_are_decoded_one_after_the_other(ending: str) -> None:
    large = cv2.resize(picture(), (64, 48), interpolation=cv2.INTER_NEAREST)
    encoded = cv2.imencode(ending, cv2.cvtColor(large, cv2.COLOR_RGB2BGR))[1].tobytes()
    decoder = PictureDecoder()
    for _ in range(3):
        message = CompressedImage(format=f"bgr8; {ending} compressed bgr8", data=encoded)
        decoded = decoder.decode(message)
        assert decoded.shape == (48, 64, 3)
        assert np.abs(decoded[24, [8, 56]].astype(int) - large[24, [8, 56]]).max() < 30


@pytest.mark.parametrize(
    ("message", "error"),
    [
        (Image(height=2, width=2, encoding="32FC1", step=8, data=bytes(16)), "'32FC1'"),
        (Image(height=600, width=800, encoding="rgb8", step=2400, data=bytes(10)), "10 bytes"),
        (Image(height=0, width=0, encoding="rgb8", step=0, data=b""), "0 x 0"),
        (CompressedImage(format="jpeg", data=b"\xff\xd8 no picture"), "picture"),
        (CompressedImage(format="compressedDepth", data=bytes(20)), "'compressedDepth'"),
    ],
)
def test_what_is_no_picture_is_refused_in_words(
    message: Image | CompressedImage, error: str
) -> None:
    with pytest.raises(OsgError, match=error):
        PictureDecoder().decode(message)
