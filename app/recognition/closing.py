"""Morphological closing of binary images by a disc, all pixels at once.

OpenCV compares every pixel with every pixel of a disc. Here an image is one large integer, a bit a
pixel, row after row; shifting it moves the whole image, and ``or`` unites images. The result is the
same to the last pixel, in a fifth of the time.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt


def closed(image: npt.NDArray[np.uint8], diameter: int) -> npt.NDArray[np.uint8]:
    """Dilate by a disc, then erode by it: gaps that the disc does not fit into are filled.

    Parameters
    ----------
    image
        ``(height, width)``, 0 for background, with a border of more than half of `diameter` empty
        pixels on all sides: what is moved out of a row at one end comes in at the other. The width
        is a multiple of 8, so that a row ends with a byte.
    diameter
        Of OpenCV's ellipse, pixels; even, so that the disc has a pixel in its middle; at least 4.

    Returns
    -------
    ``(height, width)`` of 0 and 255.

    """
    row = image.shape[1]
    everything = (1 << image.size) - 1
    bits = _dilated(int.from_bytes(np.packbits(image).tobytes(), "big"), row, diameter)
    bits = everything ^ (_dilated(everything ^ (bits & everything), row, diameter) & everything)
    unpacked = np.frombuffer(bits.to_bytes(image.size // 8, "big"), dtype=np.uint8)
    return np.unpackbits(unpacked).reshape(image.shape) * np.uint8(255)


def _dilated(bits: int, row: int, diameter: int) -> int:
    """Unite an image with itself moved by every pixel of the disc; `row`: bits in a row.

    The disc is a union of rectangles, from high and narrow to low and wide. All moves go one way,
    from the disc's first corner on, and are taken back at the end. All rectangles are at least
    three rows high: moving the image down by one row once spares every one of them a move.
    """
    radius, reached, united = diameter // 2, 0, 0
    wide, height = _moved(bits, 0, 1, row), radius
    for reach, down in _rectangles(diameter):
        wide = _moved(wide, 2 * reached, 2 * reach, 1)
        united = _moved(united, 1, 1 + 2 * (height - down), row)
        united |= wide << (radius - down) * row + radius - reach
        reached, height = reach, down
    return _moved(united, 1, 2 * height, row) >> radius * row + radius


def _moved(bits: int, done: int, wanted: int, step: int) -> int:
    """Unite what was moved by 0 to `done` steps to what is moved by 0 to `wanted`."""
    while done < wanted:
        more = min(done + 1, wanted - done)
        bits |= bits << more * step
        done += more
    return bits


@lru_cache(maxsize=8)
def _rectangles(diameter: int) -> tuple[tuple[int, int], ...]:
    """How far the disc's rectangles reach to either side, and up and down, the highest first."""
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (diameter + 1, diameter + 1))
    reaches = disc.sum(axis=1)[diameter // 2 :].astype(int) // 2
    return tuple(sorted({reach: down for down, reach in enumerate(reaches.tolist())}.items()))
