"""Clips in simulated water: what is found of a rendered diver, and what is recognised.

Rendered test clips are mixed with the water's colour and noise, compressed again as a camera
would, and read with and without the correction of colour and contrast. *Far* shrinks the diver to
half first, to about four metres away. *Blink* lets the light go twice a second, as the lights of a
vehicle do that answers the diver.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

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
from benchmarks.figures import Figure, Measurement, share
from languages.render.encode import encode

WATER_COLOUR = (40, 95, 110)
"""RGB of a green sea."""

NOISE = 8.0
"""Standard deviation in grey levels at full murk: cameras turn up their gain in the dark."""

RATE, RATE_FACTOR = 25, 26
"""Frames per second of the sample clips, and x264's constant rate factor of the degraded ones."""

CHANGING_PHASES = ("raise", "transit", "lower")
"""Phases of a clip in which the moving hand takes or leaves the salute's shape; its first and last
frame are uncertain, so these phases do not count."""

FOUR: Final = ("circle-test-1", "wedge-test-2", "line-test-2", "three-test-1")
GESTURES: Final = ("circle", "infinity", "line", "square", "sweep", "three", "triangle", "wedge")
EIGHT: Final = tuple(f"{gesture}-test-1" for gesture in GESTURES)


class Condition(NamedTuple):
    """Clips, settings of the correction, and the arguments of `degrade`."""

    clips: tuple[str, ...]
    water: tuple[WaterCorrection, ...]
    murk: float
    far: bool = False
    blink: float = 0.0


CONDITIONS: Final = {
    "near": Condition(FOUR, ("off", "auto"), 0.75),
    "far": Condition(FOUR, ("off", "auto"), 0.5, far=True),
    "blink": Condition(EIGHT, ("auto",), 0.0, blink=0.6),
    "blink-murky": Condition(EIGHT, ("auto",), 0.5, blink=0.6),
}


def degrade(
    images: Sequence[Image], murk: float, *, far: bool = False, blink: float = 0.0
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


def count_frames(recording: Recording, phases: Sequence[tuple[str, float, float]]) -> Counter[str]:
    """Count a recording's frames, bodies and hands, and its salutes by what the phases say."""
    counts = Counter(frames=len(recording.poses), hands=sum(map(len, recording.hands)))
    counts["body"] = int(np.isfinite(recording.poses.xy).all(axis=(1, 2)).sum())
    for time, score in zip(recording.poses.time, recording.salute, strict=True):
        phase = next((name for name, start, end in phases if start <= time < end), None)
        if phase is not None and phase not in CHANGING_PHASES:
            kind = "salute" if phase == "salute" else "other"
            counts[f"{kind}-frames"] += 1
            counts[kind] += bool(score > ENTER_SCORE)
    return counts


def read_clip(
    clip: Path, water: WaterCorrection, estimator: PoseEstimator, recognizer: Recognizer
) -> Counter[str]:
    """Count what is found in a clip, which is named as the sample clip it was made from."""
    recording = record(clip, estimator=estimator, water=water)
    phases = json.loads((samples_dir() / "clips" / "phases.json").read_text("utf-8"))
    counts = count_frames(recording, phases[clip.stem])
    takes = takes_in(recording)
    if [each.closed for each in takes] == [True]:
        counts["takes"] = 1
        counts["named"] = clip.stem.startswith(f"{recognizer.recognize(takes[0].poses).nearest}-")
    return counts


def measure(condition: str, quick: bool) -> Iterator[Figure]:
    """Yield what is found and recognised in some clips under a condition."""
    names, settings, murk, far, blink = CONDITIONS[condition]
    recognizer = Recognizer(Language.load(samples_dir() / "osg-table-2.json"))
    totals = {water: Counter[str]() for water in settings}
    names = names[:1] if quick else names
    with TemporaryDirectory() as scratch, closing(create_estimator(threads=1)) as estimator:
        for name in names:
            with read_frames(samples_dir() / "clips" / f"{name}.mp4") as frames:
                seen = [one.image for one in frames]
            images = [*degrade(seen, murk, far=far, blink=blink)]
            clip = Path(scratch) / f"{name}.mp4"
            clip.write_bytes(encode(images, RATE, RATE_FACTOR))
            for water, counts in totals.items():
                counts.update(read_clip(clip, water, estimator, recognizer))
    for water, counts in totals.items():
        for name, of in (
            ("body", counts["frames"]),
            ("hands", 2 * counts["frames"]),
            ("salute", counts["salute-frames"]),
            ("other", counts["other-frames"]),
            ("takes", len(names)),
            ("named", len(names)),
        ):
            yield share(f"{water}/{name}", counts[name], of)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what is found in each condition, and what the correction costs."""
    for name, (clips, _, murk, far, blink) in CONDITIONS.items():
        yield Measurement(
            f"murk/{name}",
            partial(measure, name),
            f"{len(clips)} rendered clips, murk {murk}, {'far' if far else 'near'}, blink {blink}",
            "each clip degraded, compressed and read with each setting of the correction",
        )
