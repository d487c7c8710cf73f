"""Salute: accuracy of our test and of the published rule, side by side.

Three kinds of hands: synthetic ones with joint angles known, the sample clips (a rendered diver,
who salutes when the phases say so), and photographs and drawings of hands where such a folder is
given. Only pictures in which the hand model finds a hand count, for both rules.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.extraction import record
from app.recognition.recording.salute import ENTER_SCORE, salute_score
from app.recognition.recording.video import ALPHA_BACKGROUND, over_background
from app.resources import samples_dir
from tests.recognition.parametric_hand import labelled_hands

Rule = Callable[[FloatArray], bool]

CHANGING_PHASES = ("raise", "transit", "lower")
"""Phases of a clip in which the moving hand takes or leaves the salute's shape; its first and last
frame are uncertain, so these phases do not count."""

SURROUND = 1.5
"""Picture widths of plain background added around a drawing that its hand fills: the palm detector
expects hands as a part of a picture."""

SYNTHETIC_HANDS = 3000
"""Synthetic hands: enough to measure a false-positive rate of 1 % to a quarter of its value."""


PUBLISHED_RATIO = 1.2
"""How many times wider the middle gap must be in the published rule (OSG's reference code)."""

_TIPS = [HAND_LANDMARKS.index(f"{finger}_tip") for finger in FINGERS]


def check_published_rule(hand_xy: FloatArray) -> bool:
    """Return whether the published implementation accepts a hand as a salute.

    The gap between the tips of middle and ring finger is `PUBLISHED_RATIO` times wider than the
    gap between index and middle finger, and than the one between ring and little finger.

    Parameters
    ----------
    hand_xy
        ``(21, 2)`` pixels, in the order of `HAND_LANDMARKS`.

    """
    index, middle, little = np.linalg.norm(np.diff(hand_xy[_TIPS], axis=0), axis=1)
    return bool(PUBLISHED_RATIO * index < middle and PUBLISHED_RATIO * little < middle)


def salutes(hand: FloatArray) -> bool:
    """Apply the project's own test as a rule."""
    return salute_score(hand) > ENTER_SCORE


@dataclass(frozen=True, eq=False)
class Picture:
    """The hands found in one picture.

    Attributes
    ----------
    salutes
        Whether one of them truly salutes.
    hands
        Each ``(21, 2)``, at least one.

    """

    salutes: bool
    hands: tuple[FloatArray, ...]


@dataclass(frozen=True)
class Rates:
    """How often a rule is right.

    Attributes
    ----------
    recall
        Share of the saluting pictures in which it sees a salute.
    false_positives
        Share of the other pictures in which it sees one.

    """

    recall: float
    false_positives: float

    @classmethod
    def of(cls, rule: Rule, pictures: Sequence[Picture]) -> Rates:
        """Apply a rule to every hand of every picture."""
        fires = np.array([any(map(rule, picture.hands)) for picture in pictures])
        truth = np.array([picture.salutes for picture in pictures])
        return cls(float(fires[truth].mean()), float(fires[~truth].mean()))


def synthetic_pictures(noise: float = 0.02) -> list[Picture]:
    """Return hands from joint angles, with landmark errors of `noise` palms."""
    hands = labelled_hands(SYNTHETIC_HANDS, seed=11, noise=noise)
    return [Picture(hand.salutes, (hand.xy,)) for hand in hands]


def clip_pictures(folder: Path, names: Sequence[str], estimator: PoseEstimator) -> list[Picture]:
    """Return the frames of clips whose phases are known.

    Parameters
    ----------
    folder
        Holds ``<name>.mp4`` of every name, and ``phases.json``: per name a list of phase, start
        and end in seconds.

    """
    phases = json.loads((folder / "phases.json").read_text())
    return [
        picture
        for name in names
        for picture in _frames(folder / f"{name}.mp4", phases[name], estimator)
    ]


def _frames(
    clip: Path, phases: Sequence[tuple[str, float, float]], estimator: PoseEstimator
) -> Iterator[Picture]:
    recording = record(clip, estimator=estimator)
    for time, hands in zip(recording.poses.time, recording.hands, strict=True):
        phase = next((name for name, start, end in phases if start <= time < end), None)
        if hands and phase is not None and phase not in CHANGING_PHASES:
            yield Picture(phase == "salute", tuple(hand.xy for hand in hands))


def image_pictures(folder: Path, estimator: PoseEstimator) -> list[Picture]:
    """Return the still images of ``salute/`` and ``other/`` in a folder, in which hands are found.

    Drawings (PNG, WebP) are put on a plain background; photographs (JPEG) are taken as they are.
    """
    found = []
    for kind in ("salute", "other"):
        for path in sorted((folder / kind).iterdir()):
            estimator.reset()
            hands = estimator.estimate(_readable(path), 0.0).hands
            if hands:
                found.append(Picture(kind == "salute", tuple(hand.xy for hand in hands)))
    return found


def _readable(path: Path) -> Image:
    """Read an image as RGB, with a plain background behind and around a drawing."""
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise OSError(f"{path} is not a readable image")
    has_alpha = image.ndim == 3 and image.shape[2] == 4
    image = cv2.cvtColor(image, cv2.COLOR_BGRA2RGBA if has_alpha else cv2.COLOR_BGR2RGB)
    rgb = over_background(np.asarray(image, np.uint8)) if has_alpha else np.asarray(image, np.uint8)
    if path.suffix == ".jpg":
        return rgb
    width = round(SURROUND * max(rgb.shape[:2]))
    grey = (ALPHA_BACKGROUND,) * 3
    framed = cv2.copyMakeBorder(rgb, width, width, width, width, cv2.BORDER_CONSTANT, value=grey)
    return np.asarray(framed, np.uint8)


def report(title: str, pictures: Sequence[Picture]) -> None:
    """Print the rates of both rules on some pictures."""
    saluting = sum(picture.salutes for picture in pictures)
    print(f"{title}: {saluting} salutes, {len(pictures) - saluting} others")
    rules: dict[str, Rule] = {"published rule": check_published_rule, "salute_score": salutes}
    for name, rule in rules.items():
        rates = Rates.of(rule, pictures)
        print(f"  {name:15} recall {rates.recall:.3f}  false positives {rates.false_positives:.4f}")


def main() -> None:
    """Print the table; ``--images FOLDER`` adds still images."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.accuracy.salute", description=__doc__
    )
    parser.add_argument("--images", type=Path, help="folder with salute/ and other/")
    images: Path | None = parser.parse_args().images
    report("synthetic hands", synthetic_pictures())
    clips = samples_dir() / "clips"
    names = sorted(path.stem for path in clips.glob("*-demonstration.mp4"))
    with closing(create_estimator()) as estimator:
        report("frames of the demonstrations", clip_pictures(clips, names, estimator))
        if images is not None:
            report("still images", image_pictures(images, estimator))


if __name__ == "__main__":
    main()
