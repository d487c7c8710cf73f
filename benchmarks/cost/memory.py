"""Memory: tests whether the peak grows with the length of the clip.

The peak resident memory of extracting one minute and ten minutes of the same looped clip, each in
a process of its own.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import av

from app.resources import samples_dir

MINUTES = (1, 10)
FRAMES_PER_SECOND = 4
"""Frames a second: few, so that ten minutes run in acceptable time; leaks would grow per frame."""

CHILD = """
import resource, sys
from app.recognition import record
recording = record(sys.argv[1])
print(len(recording.poses), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def looped_clip(source: Path, target: Path, minutes: int) -> None:
    """Write the frames of `source` over and over until `minutes` are full."""
    with av.open(str(source)) as container:
        images = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    height, width = images[0].shape[:2]
    with av.open(str(target), "w") as container:
        stream = container.add_stream("libx264", rate=FRAMES_PER_SECOND, options={"preset": "fast"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for number in range(minutes * 60 * FRAMES_PER_SECOND):
            frame = av.VideoFrame.from_ndarray(images[number % len(images)], format="rgb24")
            frame.pts, frame.time_base = number, Fraction(1, FRAMES_PER_SECOND)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


def main() -> None:
    """Print the peaks side by side, relative to the shorter clip."""
    peaks = []
    with tempfile.TemporaryDirectory() as folder:
        for minutes in MINUTES:
            clip = Path(folder) / f"{minutes}.mp4"
            looped_clip(samples_dir() / "clips" / "circle-demonstration.mp4", clip, minutes)
            child = subprocess.run(
                [sys.executable, "-c", CHILD, str(clip)], check=True, capture_output=True, text=True
            )
            frames, peak = map(int, child.stdout.split())
            peaks.append(peak)
            print(
                f"peak memory of extracting {minutes:>2} min ({frames} frames): {peak / 1e3:.0f} MB"
            )
    print(f"ratio {peaks[1] / peaks[0]:.2f} for {MINUTES[1] / MINUTES[0]:.0f} times the length")
