"""Encoder: writes frames as an H.264 file for all browsers, within a size limit."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, log
from pathlib import Path
from tempfile import TemporaryDirectory

import av
import numpy as np
import numpy.typing as npt

Frame = npt.NDArray[np.uint8]

SIZE_LIMIT = 148_000
"""Bytes; the sample clips may have 150 kB each."""
FIRST_RATE_FACTOR = 23
"""x264's own default for its constant rate factor; lower is better and larger."""
GROWTH_PER_STEP = 1.12
"""By how much a clip shrinks per step of the rate factor; x264 documents about a half every six."""


def encode_within_limit(frames: Sequence[Frame], rate: int, limit: int = SIZE_LIMIT) -> bytes:
    """Encode at about the best quality that keeps the file within `limit` bytes.

    Parameters
    ----------
    frames
        ``(height, width, 3)`` RGB each.
    rate
        Frames per second.
    limit
        Bytes.

    """
    first = encode(frames, rate, FIRST_RATE_FACTOR)
    factor = FIRST_RATE_FACTOR + ceil(log(len(first) / limit) / log(GROWTH_PER_STEP))
    clip = encode(frames, rate, factor)
    while len(clip) > limit:
        factor += 1
        clip = encode(frames, rate, factor)
    return clip


def encode(frames: Sequence[Frame], rate: int, rate_factor: int) -> bytes:
    """Encode as MP4: H.264 in 4:2:0 with its index first, so that playing starts at once.

    One thread: with more, x264 gives other bytes on other machines.
    """
    with TemporaryDirectory() as folder:
        # Moving the index to the front needs a file that can be read again.
        path = Path(folder) / "clip.mp4"
        _write(path, frames, rate, rate_factor)
        return path.read_bytes()


def _write(path: Path, frames: Sequence[Frame], rate: int, rate_factor: int) -> None:
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=rate)
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        stream.thread_count = 1
        # A key frame every two seconds lets a player seek without decoding the whole clip.
        stream.gop_size = 2 * rate
        stream.codec_context.time_base = Fraction(1, rate)
        stream.options = {"crf": str(rate_factor), "preset": "slow", "profile": "high"}
        for image in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
