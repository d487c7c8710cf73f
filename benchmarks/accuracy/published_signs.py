"""Published sets of divers' signs: SDG11, SCUBANetV2 and CADDY's gestures.

Each lies in a folder of its name, in the layout in which its authors give it:

- SDG11: eleven signs in clips of about two seconds, ``SIGN/SIGN_PLACE_VIEW_id.MP4``, where PLACE is
  TANK, SEA, SPRINGS and so on, perhaps with a modifier (AQUARIUM-LOWVIZ), and VIEW is VERTICAL or
  HORIZONTAL, how the diver lies (aprilab-uf/SDG11, `dataset_contribution_guide.md`).
- SCUBANetV2: clips of a diver who repeats one sign, ``NAME.mp4`` beside ``NAME.json``:
  ``{"file_name": ..., "labels": [{"frame": 0, "label": null}, ...]}``. Label null: nothing is said
  about the frame; ``Idle``: no sign (YorkCFR/SCUBANetV2).
- CADDY: pairs of pictures of a diver who holds a hand sign.
  ``CADDY_gestures_all_true_positives_release_v2.csv`` lists the pictures in the order in which they
  were taken, with ``scenario``, ``stereo left`` (path below the folder), ``label name``, and
  ``synthetic`` (0: as the camera gave it); ``..._true_negatives_...`` those of divers who show no
  sign. Only the left pictures are used (Gomez Chavez et al. 2019, Sec. 4).

In each draw one random take per sign makes a language; all other takes of the signs are queries, up
to a number. A query is *alike* if the demonstration of its sign was shown in the same setting
(SDG11: place and view; SCUBANetV2: clip; CADDY: scenario), else *other*. A take without a sign that
is not refused is a false alarm. These sets do not name people.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import cv2
import numpy as np
from pydantic import BaseModel, NonNegativeInt, ValidationError

from app.clip_sources import is_take
from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import (
    Gesture,
    GestureError,
    Language,
    OsgError,
    PoseSequence,
    Recognizer,
    takes_in,
)
from app.recognition.poses.frame import Image
from app.recognition.recording.video import VideoFrame, VideoInfo
from benchmarks.accuracy.hand_shapes import ask, count
from benchmarks.figures import Figure, Measurement, share
from benchmarks.sets.hand_shape_draws import Drawn, Take

IDLE: Final = "Idle"
"""SCUBANetV2's label of frames without a sign."""

SHORTEST: Final = 5
"""Fewest frames of a run of SCUBANetV2; a shorter one is a labelling mistake."""

SDG11_NAME: Final = re.compile(
    r"(?P<sign>[^_]+(?:_[^_]+)*?)_(?P<place>[A-Z-]+)_(?P<view>VERTICAL|HORIZONTAL)_[^_]+", re.I
)
"""Names of SDG11's clips, without their ending."""

NO_SIGNS: Final = "*true_negatives*.csv"
COLUMNS: Final = ("scenario", "stereo left", "label name", "synthetic")
"""Columns of CADDY's tables that are read."""

RATE: Final = 10.0
"""CADDY's pictures a second, about as fast as they were taken."""

LONGEST: Final = 10
"""Most pictures in a take of CADDY: the following ones of a run are nearly the same."""


@dataclass(frozen=True, eq=False)
class DiverTake:
    """One take of a set.

    Attributes
    ----------
    label
        The sign that is shown; None if it is not one of the set's.
    setting
        Key shared by takes in the same setting: place and view, clip, or scenario.
    poses
        Body and hands.

    """

    label: str | None
    setting: str
    poses: PoseSequence


def find_runs(labels: Iterable[str | None]) -> Iterator[tuple[str | None, int, int]]:
    """Yield the label, the first and the last index of each run of equal labels."""
    for label, run in groupby(enumerate(labels), key=lambda pair: pair[1]):
        indices = [index for index, _ in run]
        yield label, indices[0], indices[-1]


def read_sdg11(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take a clip: what lies between salutes, or all of it where there are none."""
    for path in sorted(folder.glob("*/*")):
        if is_take(path) and (name := SDG11_NAME.fullmatch(path.stem)) is not None:
            recording = recorder.record(path)
            takes = takes_in(recording)
            setting = f"{name['place']} {name['view']}".upper()
            poses = takes[0].poses if takes else recording.poses
            yield DiverTake(path.parent.name, setting, poses)


class FrameLabel(BaseModel):
    """The label of one frame."""

    frame: NonNegativeInt
    label: str | None


class ClipLabels(BaseModel):
    """The labels of one clip."""

    file_name: str
    labels: list[FrameLabel]


def read_scubanet(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take for every run of frames with the same label, also of those without a sign."""
    for path in sorted(folder.rglob("*.json")):
        clip = path.with_suffix(".mp4")
        if not clip.is_file():
            continue
        try:
            content = ClipLabels.model_validate_json(path.read_text(encoding="utf-8"))
        except ValidationError as error:
            raise OsgError(f"{path.name} is no label file of SCUBANetV2: {error}") from error
        labels = {each.frame: each.label for each in content.labels}
        poses = recorder.record(clip).poses
        for label, first, last in find_runs(labels.get(index) for index in range(len(poses))):
            if label is not None and last - first + 1 >= SHORTEST:
                shown = poses.between(float(poses.time[first]), float(poses.time[last]))
                yield DiverTake(None if label == IDLE else label, path.stem, shown)


def read_picture(path: Path) -> Image:
    """Return a picture file as RGB.

    Raises
    ------
    OsgError
        When it cannot be read.

    """
    stored = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if stored is None:
        raise OsgError(f"{path} is no picture; JPEG and PNG are read")
    return np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB), np.uint8)


class Pictures:
    """Frames from picture files, `RATE` a second."""

    def __init__(self, paths: list[Path]) -> None:
        self._paths = paths
        height, width, _ = read_picture(paths[0]).shape
        seconds = len(paths) / RATE
        self.info = VideoInfo(
            width=width, height=height, duration=seconds, frames=len(paths), rotation=0, codec=""
        )
        self.warnings: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[VideoFrame]:
        """Read the pictures one after the other."""
        for index, path in enumerate(self._paths):
            yield VideoFrame(index, index / RATE, read_picture(path))


def read_caddy(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take for each run of pictures of one scenario with the same sign."""
    for table in sorted(folder.glob("*true_[pn]*tives*.csv")):
        with table.open(encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            if missing := set(COLUMNS) - set(reader.fieldnames or ()):
                raise OsgError(f"{table.name} has no column {', '.join(sorted(missing))}")
            rows = [row for row in reader if row["synthetic"].strip() == "0"]
        for _, first, last in find_runs(f"{row['scenario']}/{row['label name']}" for row in rows):
            shown = rows[first : min(last + 1, first + LONGEST)]
            paths = [folder / row["stereo left"].strip().lstrip("/") for row in shown]
            yield DiverTake(
                None if table.match(NO_SIGNS) else shown[0]["label name"],
                shown[0]["scenario"],
                recorder.record_frames(Pictures(paths)).poses,
            )


Reader = Callable[[Path, ClipRecorder], Iterator[DiverTake]]
"""Yields the takes of a folder.

Raises `OsgError` when a file cannot be read, or the models are not installed."""

READERS: Final[dict[str, Reader]] = {
    "SDG11": read_sdg11,
    "SCUBANetV2": read_scubanet,
    "CADDY": read_caddy,
}
"""By the authors' name of the set."""

DRAWS, QUERIES = 20, 200


def make_gestures(takes: Sequence[DiverTake]) -> dict[int, Gesture]:
    """Make a gesture of each take that can be a demonstration, by the take's number."""
    made = {}
    for number, take in enumerate(takes):
        if take.label is not None:
            try:
                made[number] = Gesture.from_demonstration(take.label, take.poses)
            except GestureError:
                continue
    return made


def draw_signs(
    takes: Sequence[DiverTake], gestures: dict[int, Gesture], draws: int, queries: int, seed: int
) -> Iterator[Drawn]:
    """Draw languages of one take a sign, with the takes that they are asked about."""
    generator = np.random.default_rng(seed)
    signs = sorted({each.label for each in gestures.values()})
    for _ in range(draws if len(signs) > 1 else 0):
        shown = {
            sign: int(generator.choice([n for n, each in gestures.items() if each.label == sign]))
            for sign in signs
        }
        language = Language("drawn", [gestures[number] for number in shown.values()])
        left = [
            number
            for number, take in enumerate(takes)
            if number not in shown.values() and (take.label is None or take.label in shown)
        ]
        asked = []
        for number in generator.permutation(left)[:queries].tolist():
            label, relation = takes[number].label, "no-sign"
            if label is not None:
                same = takes[shown[label]].setting == takes[number].setting
                relation = "alike" if same else "other"
            asked.append(Take(relation, label or "no sign", takes[number].poses))
        yield Drawn(Recognizer(language), asked)


def measure(folder: Path, name: str, quick: bool) -> Iterator[Figure]:
    """Yield how many takes can be a demonstration, and what the others are read as."""
    with TemporaryDirectory() as keep, closing(ClipRecorder(Path(keep))) as recorder:
        takes = [*READERS[name](folder, recorder)]
    gestures = make_gestures(takes)
    yield share("demonstrations", len(gestures), sum(take.label is not None for take in takes))
    draws = 2 if quick else DRAWS
    yield from count(ask(draw_signs(takes, gestures, draws, QUERIES, seed=1)))


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the accuracy on each set."""
    for name in READERS:
        yield Measurement(
            f"published-signs/{name}",
            partial(measure, folder / name, name),
            name,
            f"{DRAWS} languages of one take a sign, {QUERIES} takes each",
            reads=(folder / name,),
        )
