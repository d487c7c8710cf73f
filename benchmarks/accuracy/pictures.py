"""Pictures: what people see in photographs of divers and of hands, against what is found.

``water_stills/`` holds ``boxes.csv`` (columns image, what, x0, y0, x1, y1: Diver, Head or Hand, and
corners in pixels) and the photographs in ``images/``; the letters at the beginning of a file's name
denote its water. Each photograph is processed by itself: the estimator is reset before it. As the
first frame of a clip, one in which no hand is found is examined under every correction, and
searched in parts.

- body: photographs with a diver's box; found if the centre of shoulders and hips is in one.
- head: photographs with a head's box; found if the nose is in one.
- hand: boxes of hands; found if the centre of a found hand's landmarks is in it.
- stray: hands found whose middle is in no hand's box, of all hands found. Boxes are missing around
  some hands that people see, so a part of these is right.
- place: boxes of hands; found if the middle of a found hand, or of the place of one whose fingers
  are not seen, is in it.
- wrong: hands and places found that are in no hand's box, a photograph.
- wrist: boxes of hands; found if a wrist of the body that is followed is within 0.3 of
  `measure_body` of the box's middle, or within half of the box's longer side: the hands of near
  divers are so large that their own wrists are farther from their middles than 0.3 of the body.

Each is counted for all photographs, by water, by the height of the diver's box as a share of the
picture's, and for those that chose no constant of what finds hands (*held*), also by water.

*Salutes*: our test of a hand and the published rule, on the same hands: made from known joint
angles, and found in pictures of hands (``hands/`` with ``salute/`` and ``other/``), of which only
those with a hand found count, for both rules. Counted beside: how often a picture of a hand, or of
plain water, is taken for a body. Every share has Wilson's 95 % interval.
"""

from __future__ import annotations

import csv
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple
from unittest.mock import patch

import cv2
import numpy as np

from app.evaluation.share import Share
from app.recognition.estimation import factory
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.landmark_models.arms import measure_body
from app.recognition.estimation.water import WaterCorrection, WaterSight
from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import ENTER_SCORE, salute_score
from app.recognition.recording.video import ALPHA_BACKGROUND, over_background
from benchmarks.accuracy.published_signs import read_picture
from benchmarks.figures import FINDING, Figure, Measurement, Results, share, table
from tests.recognition.parametric_hand import labelled_hands

ALL: Final = slice(None)
HELD: Final = slice(2, None, 5)
"""Photographs of the sorted names that chose no constant of what finds hands."""

TORSO: Final = [
    POSE_LANDMARKS.index(f"{side}_{joint}")
    for side in ("left", "right")
    for joint in ("shoulder", "hip")
]
NOSE: Final = POSE_LANDMARKS.index("nose")
WRISTS: Final = [POSE_LANDMARKS.index(f"{side}_wrist") for side in ("left", "right")]

WRIST_REACH: Final = 0.3
"""Distance from a wrist to the middle of its hand's box, in body sizes, that is right also where
the hand is smaller."""

SIZES: Final = {"far": 0.5, "middle": 0.75, "near": 1.01}
"""Rows by size, with the share of the picture's height that the diver's box is lower than."""

LEAST_WATER: Final = 0.3
"""Least width of a crop of water beside the diver, as a share of the picture's."""


@dataclass(frozen=True)
class Still:
    """A photograph and what people see in it.

    Attributes
    ----------
    path
        The file.
    boxes
        For Diver, Head and Hand the corners ``(N, 2, 2)``, (left, top) and (right, bottom).
    held
        Whether it is one of `HELD`.

    """

    path: Path
    boxes: Mapping[str, FloatArray]
    held: bool = False

    @property
    def water(self) -> str:
        """The letters that the file's name begins with."""
        letters = re.match(r"[A-Za-z]*", self.path.name)
        return letters.group() if letters else ""

    def groups(self, height: int) -> Iterator[str]:
        """Yield what it is counted in, in a picture of so many lines."""
        yield from ("all", self.water)
        if self.held:
            yield from ("held", f"held/{self.water}")
        if "Diver" in self.boxes:
            tall = float(np.diff(self.boxes["Diver"][..., 1], axis=1).max()) / height
            yield next(name for name, limit in SIZES.items() if tall < limit)


def read_stills(folder: Path, part: slice = ALL) -> tuple[Still, ...]:
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
    names = sorted(boxes)
    held = {*names[HELD]}
    return tuple(
        Still(
            folder / "images" / name,
            {what: np.array(corners) for what, corners in boxes[name].items()},
            name in held,
        )
        for name in names[part]
    )


def score_still(boxes: Mapping[str, FloatArray], found: FrameLandmarks) -> dict[str, Share]:
    """Compare what was found in a photograph with what people see."""
    middles = [hand.xy.mean(axis=0) for hand in found.hands]
    places = [*middles, *(np.nanmean(place.xy, axis=0) for place in found.places)]
    hands, body = boxes.get("Hand", np.empty((0, 2, 2))), found.body
    score = {}
    for name, what, landmarks in (("body", "Diver", TORSO), ("head", "Head", [NOSE])):
        if what in boxes:
            points = [] if body is None else [body.xy[landmarks].mean(axis=0)]
            score[name] = _count([_holds(boxes[what], points)])
    wrists = np.full((2, 2), np.inf) if body is None else body.xy[WRISTS]
    least = 0.0 if body is None else WRIST_REACH * measure_body(body)
    reach = np.maximum(least, np.ptp(hands, axis=1).max(axis=1) / 2)
    far = np.linalg.norm(wrists[:, None] - hands.mean(axis=1), axis=2).min(axis=0)
    return {
        **score,
        "hand": _count([_holds(box[None], middles) for box in hands]),
        "stray": _count([not _holds(hands, [middle]) for middle in middles]),
        "place": _count([_holds(box[None], places) for box in hands]),
        "wrong": _count([not _holds(hands, [place]) for place in places]),
        "wrist": _count((far <= reach).tolist()),
    }


def _count(found: Sequence[bool]) -> Share:
    return Share(sum(found), len(found))


def _holds(boxes: FloatArray, points: Iterable[FloatArray]) -> bool:
    """Return whether one of the points is in one of the boxes ``(N, 2, 2)``."""
    return any(
        bool(((box[0] <= point) & (point <= box[1])).all()) for box in boxes for point in points
    )


def measure(
    folder: Path, water: WaterCorrection, part: slice, taught: bool, quick: bool
) -> Iterator[Figure]:
    """Yield how much is found of the divers in photographs, with or without the taught models."""
    scores: dict[str, Share] = defaultdict(lambda: Share(0, 0))
    photographs = Counter[str]()
    with ExitStack() as stack:
        for name in () if taught else ("finder_path", "gloves_path"):
            stack.enter_context(patch.object(factory, name, lambda: None))
        estimator = stack.enter_context(closing(create_estimator(threads=1)))
        sight = WaterSight(estimator, water)
        for still in read_stills(folder, part)[:: 40 if quick else 1]:
            image = read_picture(still.path)
            sight.reset()
            score = score_still(still.boxes, sight.estimate(image, 0.0))
            for group in still.groups(len(image)):
                photographs[group] += 1
                for what, found in score.items():
                    scores[f"{group}/{what}"] += found
    for name, found in sorted(scores.items()):
        if name.endswith("/wrong"):
            number = photographs[name.removesuffix("/wrong")]
            yield Figure(name, found.correct / number, number, unit="ratio")
        else:
            yield share(name, found.correct, found.asked)


def crop_water(still: Still, image: Image) -> Image | None:
    """Return the wider side beside all boxes; None where it is too narrow or no diver has a box."""
    if "Diver" not in still.boxes:
        return None
    corners = np.concatenate([*still.boxes.values()])
    left, right = int(corners[..., 0].min()), int(np.ceil(corners[..., 0].max()))
    width = image.shape[1]
    beside = image[:, :left] if left > width - right else image[:, right:]
    return np.ascontiguousarray(beside) if beside.shape[1] >= LEAST_WATER * width else None


def measure_water(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield in how many crops of plain water a body is found."""
    stills = read_stills(folder)[:: 90 if quick else 4]
    images = [crop_water(still, read_picture(still.path)) for still in stills]
    yield from find_bodies("water", [image for image in images if image is not None])


def find_bodies(name: str, images: Sequence[Image]) -> Iterator[Figure]:
    """Yield in how many pictures a body is found, with the correction and without."""
    with closing(create_estimator(threads=1)) as estimator:
        for water in ("auto", "off"):
            sight, found = WaterSight(estimator, water), 0
            for image in images:
                sight.reset()
                found += sight.estimate(image, 0.0).body is not None
            yield share(f"{name}/{water}", found, len(images))


SURROUND = 1.5
"""Picture widths of plain background added around a drawing that its hand fills: the palm detector
expects hands as a part of a picture."""

SYNTHETIC_HANDS = 3000
"""Synthetic hands: enough to measure a false-positive rate of 1 % to a quarter of its value."""

PUBLISHED_RATIO = 1.2
"""How many times wider the middle gap must be in the published rule (OSG's reference code)."""

_TIPS = [HAND_LANDMARKS.index(f"{finger}_tip") for finger in FINGERS]


class Picture(NamedTuple):
    """A picture: whether one of its hands truly salutes, and its hands, ``(21, 2)`` each."""

    salutes: bool
    hands: tuple[FloatArray, ...]


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


def check_score(hand_xy: FloatArray) -> bool:
    """Apply the project's own test as a rule."""
    return salute_score(hand_xy) > ENTER_SCORE


RULES: dict[str, Callable[[FloatArray], bool]] = {
    "published": check_published_rule,
    "ours": check_score,
}


def apply_rules(pictures: Sequence[Picture]) -> Iterator[Figure]:
    """Yield the share of salutes that each rule sees, and of others that it takes for one."""
    for name, rule in RULES.items():
        for kind, salutes in (("seen", True), ("false", False)):
            fires = [any(map(rule, each.hands)) for each in pictures if each.salutes is salutes]
            yield share(f"{name}/{kind}", sum(fires), len(fires))


def measure_synthetic(quick: bool) -> Iterator[Figure]:
    """Yield the rules' rates on hands from joint angles, with errors of 0.02 palms."""
    hands = labelled_hands(SYNTHETIC_HANDS // 10 if quick else SYNTHETIC_HANDS, seed=11, noise=0.02)
    yield from apply_rules([Picture(hand.salutes, (hand.xy,)) for hand in hands])


def read_pictures(folder: Path, estimator: PoseEstimator) -> list[Picture]:
    """Return the still images of ``salute/`` and ``other/`` in a folder, in which hands are found.

    Drawings (PNG, WebP) are put on a plain background; photographs (JPEG) are taken as they are.
    """
    found = []
    for kind in ("salute", "other"):
        for path in sorted((folder / kind).iterdir()):
            estimator.reset()
            hands = estimator.estimate(read_hand(path), 0.0).hands
            if hands:
                found.append(Picture(kind == "salute", tuple(hand.xy for hand in hands)))
    return found


def read_hand(path: Path, *, framed: bool = True) -> Image:
    """Read an image as RGB, with a plain background behind a drawing, and around one if `framed`.

    Raises
    ------
    OSError
        When it cannot be read.

    """
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise OSError(f"{path} is not a readable image")
    has_alpha = image.ndim == 3 and image.shape[2] == 4
    image = cv2.cvtColor(image, cv2.COLOR_BGRA2RGBA if has_alpha else cv2.COLOR_BGR2RGB)
    rgb = over_background(np.asarray(image, np.uint8)) if has_alpha else np.asarray(image, np.uint8)
    if path.suffix == ".jpg" or not framed:
        return rgb
    width = round(SURROUND * max(rgb.shape[:2]))
    grey = (ALPHA_BACKGROUND,) * 3
    return np.asarray(
        cv2.copyMakeBorder(rgb, width, width, width, width, cv2.BORDER_CONSTANT, value=grey),
        np.uint8,
    )


def measure_pictures(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield the rules' rates on pictures of hands, and how many of these are taken for a body."""
    with closing(create_estimator(threads=1)) as estimator:
        yield from apply_rules(read_pictures(folder, estimator))
    others = sorted((folder / "other").glob("*.webp"))[:: 12 if quick else 1]
    yield from find_bodies("body", [read_hand(path, framed=False) for path in others])


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what is found in photographs of divers, and in plain water."""
    stills = folder / "water_stills"
    part: tuple[WaterCorrection, slice, bool]
    for name, part, protocol in (
        ("photographs", ("auto", ALL, True), "each by itself, water correction `auto`"),
        ("uncorrected", ("off", ALL, True), "each by itself, water correction `off`"),
        (
            "untaught",
            ("auto", HELD, False),
            "those that chose nothing, `auto`, without finder and landmark model of gloved hands",
        ),
    ):
        yield Measurement(
            f"pictures/{name}",
            partial(measure, stills, *part),
            "722 photographs of divers in five waters",
            protocol,
            reads=(stills,),
            measures=FINDING,
        )
    yield Measurement(
        "pictures/plain-water",
        partial(measure_water, stills),
        "water beside the diver in these photographs",
        "the wider side of every fourth photograph with a diver, where at least 30 % wide",
        reads=(stills,),
        measures=FINDING,
    )
    yield Measurement(
        "pictures/salutes-synthetic",
        measure_synthetic,
        "hands with known joint angles, other seed than tuned on",
        "3000 hands, two in five saluting",
        measures=FINDING,
    )
    yield Measurement(
        "pictures/salutes-pictures",
        partial(measure_pictures, folder / "hands"),
        "12 rendered salutes, 84 renders of other hand signs and 20 photographs",
        "each picture by itself; pictures in which a hand is found",
        reads=(folder / "hands",),
        measures=FINDING,
    )


PHOTOGRAPHS, UNTAUGHT = "pictures/photographs", "pictures/untaught"

WATERS: Final = {
    "barbados": "warm sea, bare hands, from the front",
    "signs": "blue, bare hands, from the front, against the light",
    "following": "blue, from behind and the side, swimming",
    "seneca": "brown lake, cold and dark, black gloves",
    "kingston": "green lake, cold, black or blue gloves, near",
}

DISTANCES: Final = {
    "far": "0 % to 50 %",
    "middle": "50 % to 75 %",
    "near": "75 % to 100 %",
}


def write_found(results: Results, groups: Mapping[str, str], head: str) -> str:
    """Write bodies, heads and hands found, a row a group of photographs."""
    kinds = ("body", "head", "hand")
    rows = []
    for group, words in groups.items():
        cells = [results.show(PHOTOGRAPHS, f"{group}/{each}", "cell?") for each in kinds]
        numbers = [results.show(PHOTOGRAPHS, f"{group}/{each}", "n?") for each in kinds]
        rows.append([words, *cells, " / ".join(numbers)])
    return table((head, "body, %", "head, %", "hand, %", "n"), rows)


def write_places(results: Results) -> str:
    """Write where a hand is, with the taught models and without."""
    head = ("water", "n", "fingers, %", "place, %", "wrong places a photograph", "wrist right, %")
    rows = []
    groups = {f"held/{water}": words for water, words in WATERS.items()} | {"held": "all"}
    for group, words in groups.items():
        cells = [words, results.show(PHOTOGRAPHS, f"{group}/hand", "n?")]
        for kind in ("hand", "place", "wrong", "wrist"):
            name = f"{group}/{kind}"
            without = results.show(UNTAUGHT, name, "bare?")
            cells.append(f"{results.show(PHOTOGRAPHS, name, 'cell?')}; {without}")
        rows.append(cells)
    return table(head, rows)


TABLES = {
    "waters": partial(write_found, groups=WATERS, head="water, gloves, view"),
    "distances": partial(write_found, groups=DISTANCES, head="diver's height"),
    "places": write_places,
}
