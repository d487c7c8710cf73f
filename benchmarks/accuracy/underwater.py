"""Underwater images: effect of the correction of colour and contrast.

Our rendered test clips are mixed with the water's colour and noise, compressed again as a camera
would, and read with and without the correction. ``--far`` shrinks the diver to half first, to
about four metres away. ``--blink`` lets the light go twice a second, as the lights of a vehicle do
that answers the diver.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

import cv2
import numpy as np

from app.recognition import Language, Recognizer, Recording, record, takes_in
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import Image
from app.recognition.recording.salute import ENTER_SCORE
from app.recognition.recording.video import read_frames
from app.resources import samples_dir
from app.robot.commands.replies import PULSE_SECONDS
from benchmarks.accuracy.salute import CHANGING_PHASES
from languages.render.encode import encode

MURK: tuple[float, ...] = (0.0, 0.5, 0.75)
"""Shares of the water's own colour in every pixel."""

WATER_COLOUR = (40, 95, 110)
"""RGB of a green sea."""

NOISE = 8.0
"""Standard deviation in grey levels at full murk: cameras turn up their gain in the dark."""

RATE, RATE_FACTOR = 25, 26
"""Frames per second of the sample clips, and x264's constant rate factor of the degraded ones."""


@dataclass(frozen=True)
class Found:
    """Detection rates over some clips, as shares except for the counts.

    Attributes
    ----------
    body, hands
        Share of frames with a body, and of hands found, out of two per frame.
    salutes, false_salutes
        Share of salute frames in which a salute is seen, and of other frames in which one is seen.
    takes, named
        Clips with exactly one closed take, and clips whose take is recognised correctly.
    clips
        How many there were.

    """

    body: float
    hands: float
    salutes: float
    false_salutes: float
    takes: int
    named: int
    clips: int


def degrade(
    images: Sequence[Image], murk: float, *, far: bool, blink: float = 0.0
) -> Iterator[Image]:
    """Mix each image with `murk` of the water's colour and with noise; halve it before if `far`.

    `blink` is the share of the light that goes out and comes again, twice a second.
    """
    generator = np.random.default_rng(0)
    for number, image in enumerate(images):
        clear = _halve(image) if far else image
        is_dark = number / RATE % PULSE_SECONDS >= PULSE_SECONDS / 2
        light = 1 - blink if is_dark else 1.0
        noise = generator.normal(0, NOISE * murk, clear.shape)
        mixed = (1 - murk) * light * clear + murk * np.array(WATER_COLOUR) + noise
        yield np.clip(mixed, 0, 255).astype(np.uint8)


def _halve(image: Image) -> Image:
    """Shrink the image to half and draw its edges out to its old size."""
    height, width = image.shape[:2]
    small = cv2.resize(image, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
    rows, columns = height - height // 2, width - width // 2
    edges = (rows // 2, rows - rows // 2, columns // 2, columns - columns // 2)
    return np.asarray(cv2.copyMakeBorder(small, *edges, cv2.BORDER_REPLICATE), np.uint8)


def measure(
    clips: Sequence[Path],
    water: WaterCorrection,
    estimator: PoseEstimator,
    recognizer: Recognizer,
    phases: dict[str, list[tuple[str, float, float]]],
) -> Found:
    """Read degraded clips, each named as the sample clip it was made from."""
    body, hands, salutes, false_salutes = [], [], [], []
    takes = named = 0
    for clip in clips:
        recording = record(clip, estimator=estimator, water=water)
        body.append(np.isfinite(recording.poses.xy).all(axis=(1, 2)).mean())
        hands.append(np.mean([len(found) for found in recording.hands]) / 2)
        saluting, resting = _rate_salutes(recording, phases[clip.stem])
        salutes.append(saluting)
        false_salutes.append(resting)
        found = takes_in(recording)
        if [take.closed for take in found] == [True]:
            takes += 1
            named += clip.stem.startswith(f"{recognizer.recognize(found[0].poses).nearest}-")
    return Found(
        body=float(np.mean(body)),
        hands=float(np.mean(hands)),
        salutes=float(np.mean(salutes)),
        false_salutes=float(np.mean(false_salutes)),
        takes=takes,
        named=named,
        clips=len(clips),
    )


def _rate_salutes(
    recording: Recording, phases: Sequence[tuple[str, float, float]]
) -> tuple[float, float]:
    """Shares of a clip's saluting and of its other frames in which a salute is seen."""
    names = [
        next((name for name, start, end in phases if start <= time < end), None)
        for time in recording.poses.time
    ]
    saluting = np.array([name == "salute" for name in names])
    other = np.array(
        [name is not None and name not in ("salute", *CHANGING_PHASES) for name in names]
    )
    seen = recording.salute > ENTER_SCORE
    return float(seen[saluting].mean()), float(seen[other].mean())


def main() -> None:
    """Print one line per degree of murk and setting of the correction."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.accuracy.underwater", description=__doc__
    )
    parser.add_argument("names", nargs="*", help="clips without suffix; all test clips if none")
    parser.add_argument("--murk", type=float, nargs="+", default=MURK)
    parser.add_argument("--water", nargs="+", default=get_args(WaterCorrection))
    parser.add_argument("--far", action="store_true", help="half as large, with more water around")
    parser.add_argument("--blink", type=float, default=0.0, help="share of the light, 0 to 1")
    arguments = parser.parse_args()
    folder = samples_dir() / "clips"
    names = arguments.names or sorted(path.stem for path in folder.glob("*-test-*.mp4"))
    phases = json.loads((folder / "phases.json").read_text())
    recognizer = Recognizer(Language.load(samples_dir() / "osg-table-2.json"))
    print("murk | water | bodies | hands | salutes | false salutes | takes | named")
    with TemporaryDirectory() as scratch, closing(create_estimator()) as estimator:
        for murk in arguments.murk:
            clips = [Path(scratch) / f"{name}.mp4" for name in names]
            for clip in clips:
                with read_frames(folder / clip.name) as frames:
                    seen = [one.image for one in frames]
                images = list(degrade(seen, murk, far=arguments.far, blink=arguments.blink))
                clip.write_bytes(encode(images, RATE, RATE_FACTOR))
            for water in arguments.water:
                found = measure(clips, water, estimator, recognizer, phases)
                print(
                    f"{murk:.0%} | {water} | {found.body:.1%} | {found.hands:.1%} | "
                    f"{found.salutes:.1%} | {found.false_salutes:.1%} | "
                    f"{found.takes}/{found.clips} | {found.named}/{found.clips}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
