"""Water stills: how much of real divers is found in photographs from several waters.

FOLDER holds ``boxes.csv`` (columns image, what, x0, y0, x1, y1: Diver, Head or Hand, and corners in
pixels) and the photographs in ``images/``; the letters at the beginning of a file's name denote its
water. Each photograph is processed by itself: the estimator is reset before it. As the first frame
of a clip, one in which no hand is found is examined under every correction, and searched in parts.

- body: photographs with a diver's box; found if the centre of shoulders and hips is in one.
- head: photographs with a head's box; found if the nose is in one.
- hand: boxes of hands; found if the centre of a found hand's landmarks is in it.
- off: hands found whose middle is in no hand's box, of all hands found. Boxes are missing around
  some hands that people see, so a part of these is right.
- place: boxes of hands; found if the middle of a found hand, or of the place of one whose fingers
  are not seen, is in it.
- wrong: hands and places found that are in no hand's box, of all found; the table's last column
  divides them by the number of photographs.
- wrist: boxes of hands; found if the box's middle is within 0.3 of `measure_body` of a wrist of the
  body that is followed.
- runs: runs of the models a photograph takes.

Every share has its number and Wilson's 95 % interval. ``--part even`` takes every second photograph
of the sorted names, on which constants are chosen, ``--part odd`` the others; the finder's
constants are chosen on ``--part chosen`` and measured on ``--part held``, with and
``--without-finder``. ``--by-size`` prints rows by the height of the diver's box, as a share of the
picture's, instead of by water.

    python -m benchmarks.accuracy.water_stills FOLDER --water off auto
"""

from __future__ import annotations

import argparse
import csv
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Final, Literal, get_args
from unittest.mock import patch

import cv2
import numpy as np

from app.evaluation.share import Share
from app.recognition.estimation import factory
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.landmark_models.arms import measure_body
from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Tensor
from app.recognition.estimation.water import WaterCorrection, WaterSight
from app.recognition.poses.frame import Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

Part = Literal["all", "even", "odd", "chosen", "held"]

PARTS: Final[dict[Part, slice]] = {
    "all": slice(None),
    "even": slice(0, None, 2),
    "odd": slice(1, None, 2),
    "chosen": slice(0, None, 5),
    "held": slice(2, None, 5),
}

NOTHING: Final = Share(0, 0)

TORSO: Final = [
    POSE_LANDMARKS.index(f"{side}_{joint}")
    for side in ("left", "right")
    for joint in ("shoulder", "hip")
]
NOSE: Final = POSE_LANDMARKS.index("nose")

WRISTS: Final = [POSE_LANDMARKS.index(f"{side}_wrist") for side in ("left", "right")]
WRIST_REACH: Final = 0.3
"""Distance from a wrist to the middle of its hand's box, in body sizes, that is right."""

SIZES: Final = (0.0, 0.5, 0.75, 1.01)
"""Limits of the rows by size: far, near, and as large as the picture."""


@dataclass(frozen=True)
class Still:
    """A photograph and what people see in it.

    Attributes
    ----------
    path
        The file.
    boxes
        For Diver, Head and Hand the corners ``(N, 2, 2)``, (left, top) and (right, bottom).

    """

    path: Path
    boxes: Mapping[str, FloatArray]

    @property
    def water(self) -> str:
        """The letters that the file's name begins with."""
        letters = re.match(r"[A-Za-z]*", self.path.name)
        return letters.group() if letters else ""


@dataclass(frozen=True)
class Score:
    """Counts of what was found in some photographs; the module's docstring defines them."""

    body: Share = NOTHING
    head: Share = NOTHING
    hand: Share = NOTHING
    off: Share = NOTHING
    place: Share = NOTHING
    wrong: Share = NOTHING
    wrist: Share = NOTHING

    def __add__(self, other: Score) -> Score:
        return Score(
            *(getattr(self, part.name) + getattr(other, part.name) for part in fields(self))
        )

    def __str__(self) -> str:
        shares: list[Share] = [getattr(self, part.name) for part in fields(self)]
        return " | ".join(f"{share}, n = {share.asked}" for share in shares)


def read_stills(folder: Path, part: Part = "all") -> tuple[Still, ...]:
    """Return the photographs of a folder in the order of their names.

    Raises
    ------
    OSError
        When there is no ``boxes.csv``.

    """
    boxes: dict[str, dict[str, list[list[list[float]]]]] = defaultdict(lambda: defaultdict(list))
    with (folder / "boxes.csv").open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            corners = [[float(row["x0"]), float(row["y0"])], [float(row["x1"]), float(row["y1"])]]
            boxes[row["image"]][row["what"]].append(corners)
    names = sorted(boxes)[PARTS[part]]
    return tuple(
        Still(
            folder / "images" / name,
            {what: np.array(corners) for what, corners in boxes[name].items()},
        )
        for name in names
    )


def score_still(boxes: Mapping[str, FloatArray], found: FrameLandmarks) -> Score:
    """Compare what was found in a photograph with what people see."""
    middles = [hand.xy.mean(axis=0) for hand in found.hands]
    places = [*middles, *(np.nanmean(place.xy, axis=0) for place in found.places)]
    hands = boxes.get("Hand", np.empty((0, 2, 2)))
    hits = [_holds(box[None], middles) for box in hands]
    strays = [not _holds(hands, [middle]) for middle in middles]
    wrong = [not _holds(hands, [place]) for place in places]
    body = found.body
    at_wrist = [body is not None and _is_near(box.mean(axis=0), body) for box in hands]
    return Score(
        body=_one(boxes.get("Diver"), body.xy[TORSO].mean(axis=0) if body else None),
        head=_one(boxes.get("Head"), body.xy[NOSE] if body else None),
        hand=Share(sum(hits), len(hits)),
        off=Share(sum(strays), len(strays)),
        place=Share(sum(_holds(box[None], places) for box in hands), len(hands)),
        wrong=Share(sum(wrong), len(wrong)),
        wrist=Share(sum(at_wrist), len(hands)),
    )


def _is_near(middle: FloatArray, body: Body) -> bool:
    far = np.linalg.norm(body.xy[WRISTS] - middle, axis=1).min()
    return bool(far <= WRIST_REACH * measure_body(body))


def _one(boxes: FloatArray | None, point: FloatArray | None) -> Share:
    if boxes is None:
        return NOTHING
    return Share(int(point is not None and _holds(boxes, [point])), 1)


def _holds(boxes: FloatArray, points: Iterable[FloatArray]) -> bool:
    """Return whether one of the points is in one of the boxes ``(N, 2, 2)``."""
    return any(
        bool(((box[0] <= point) & (point <= box[1])).all()) for box in boxes for point in points
    )


def size_of(still: Still, image: Image) -> str:
    """Return the row by size that a photograph belongs to."""
    if "Diver" not in still.boxes:
        return "no diver's box"
    heights = np.diff(still.boxes["Diver"][..., 1], axis=1)
    share = float(heights.max()) / image.shape[0]
    upper = next(limit for limit in SIZES[1:] if share < limit)
    lower = SIZES[SIZES.index(upper) - 1]
    return f"diver {lower:.0%} to {min(upper, 1):.0%} of the height"


def read_photograph(path: Path) -> Image:
    """Return a picture file as RGB.

    Raises
    ------
    OSError
        When it cannot be read.

    """
    image = cv2.imread(str(path))
    if image is None:
        raise OSError(f"{path} is no picture; JPEG and PNG are read")
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), np.uint8)


def measure(
    stills: Iterable[Still], sight: WaterSight, *, by_size: bool = False
) -> Iterator[tuple[str, Score]]:
    """Yield the row that each photograph belongs to, and its score."""
    for still in stills:
        image = read_photograph(still.path)
        sight.reset()
        row = size_of(still, image) if by_size else still.water
        yield row, score_still(still.boxes, sight.estimate(image, 0.0))


@contextmanager
def count_runs() -> Iterator[list[int]]:
    """Count the runs of models within the context, in the only element of the list."""
    runs, run = [0], ModelSession.run

    def counted(session: ModelSession, lowest: float = 0.0) -> list[Tensor]:
        runs[0] += 1
        return run(session, lowest)

    with patch.object(ModelSession, "run", counted):
        yield runs


def main() -> None:
    """Print a table for each setting of the correction: a row per water, and all."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.accuracy.water_stills", description=__doc__.partition("\n")[0]
    )
    parser.add_argument("folder", type=Path, help="holds boxes.csv and images/")
    parser.add_argument("--water", nargs="+", default=get_args(WaterCorrection))
    parser.add_argument("--part", choices=get_args(Part), default="all")
    parser.add_argument("--by-size", action="store_true", help="rows by size instead of by water")
    parser.add_argument("--without-finder", action="store_true", help="as where it is missing")
    arguments = parser.parse_args()
    stills = read_stills(arguments.folder, arguments.part)
    print(
        "correction | photographs of | body | head | hand | hands off any box | place | "
        "places off any box | wrist | wrong places a photograph"
    )
    with ExitStack() as stack:
        if arguments.without_finder:
            stack.enter_context(patch.object(factory, "finder_path", lambda: None))
        estimator = stack.enter_context(closing(create_estimator()))
        runs = stack.enter_context(count_runs())
        for water in arguments.water:
            rows: dict[str, Score] = defaultdict(Score)
            counts: Counter[str] = Counter()
            sight = WaterSight(estimator, water)
            for row, score in measure(stills, sight, by_size=arguments.by_size):
                rows[row] += score
                counts[row] += 1
            rows["all"], counts["all"] = sum(rows.values(), Score()), len(stills)
            for row, score in sorted(rows.items(), key=lambda each: (each[0] == "all", each[0])):
                wrong = score.wrong.correct / max(counts[row], 1)
                print(f"{water} | {row} | {score} | {wrong:.2f}", flush=True)
            print(f"{water}: {runs[0] / max(len(stills), 1):.1f} runs a photograph", flush=True)
            runs[0] = 0


if __name__ == "__main__":
    main()
