"""Transcripts: whether readers of a drawing write the strokes that the transcript tells.

`transcripts.csv` lists 37 drawings by people and what two readers wrote who saw the pictures of
``--pictures`` alone. A stroke agrees if it does not differ as in an explanation (`Piece.differs`);
reported are the drawings in which all strokes agree with a reader's, and those in which the two
readers agree with each other.

    python -m benchmarks.accuracy.transcripts ../shared/data [--pictures FOLDER]
"""

from __future__ import annotations

import csv
from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from itertools import chain, permutations
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from pydantic import TypeAdapter

from app.evaluation.share import Share
from app.recognition import Language, PoseSequence
from app.recognition.explanation.strokes import DIRECTIONS, Piece, transcribe
from app.recognition.explanation.transcript import compare_transcripts, describe_strokes
from app.recognition.poses.trajectory import Trajectory
from benchmarks.accuracy.misreading_pictures import draw_paths
from benchmarks.sets.every_set import all_sets

TABLE: Final = Path(__file__).with_suffix(".csv")

PIECE: Final = TypeAdapter(Piece)

SETS: Final = {"digits": 10, "letters": 10, "commands": 12}
"""Sets of drawing hands, and of how many classes one drawing is taken, each by another person."""


def list_drawings(folder: Path) -> Iterator[tuple[str, Trajectory]]:
    """Yield the drawings: the eight sample gestures, and one of each class by some person."""
    for gesture in Language.load("languages/osg-table-2.json").gestures:
        assert gesture.trajectory is not None
        yield f"sample {gesture.label}", gesture.trajectory
    generator = np.random.default_rng(7)
    for recorded in all_sets(folder / "trajectories", list(SETS)):
        for label in np.unique(recorded.labels)[: SETS[recorded.name]]:
            index = int(generator.choice(np.flatnonzero(recorded.labels == label)))
            poses: PoseSequence = recorded.recordings[index]
            yield f"{recorded.name} {index}", Trajectory.from_poses(poses)


def parse_strokes(words: str) -> list[Piece]:
    """Return the strokes that a reader wrote, of both hands one after the other."""
    pieces = []
    for hand, part in enumerate(words.split(";")):
        for each in part.split(","):
            stroke = each.strip()
            sense = -1.0 if "anticlockwise" in stroke else 1.0
            ways = [way for way in DIRECTIONS if stroke.endswith(way)]
            way = max(ways, key=len, default=None)
            kind = next(
                (kind for kind in ("arc", "loop", "curve", "pause") if kind in stroke), "line"
            )
            pieces.append(
                PIECE.validate_python(
                    {
                        "kind": kind,
                        "hand": str(hand),
                        "direction": None if way is None else 45.0 * DIRECTIONS.index(way),
                        "turn": {"arc": 180.0, "loop": 360.0}.get(kind, 0.0) * sense,
                        "start": 0.0,
                        "end": 0.0,
                    }
                )
            )
    return pieces


def agree(one: Sequence[Piece], other: Sequence[Piece]) -> bool:
    """Return whether two transcripts tell the same strokes, whichever hand comes first."""
    hands = {piece.hand: [each for each in other if each.hand == piece.hand] for piece in other}
    orders = [list(chain(*row)) for row in permutations(hands.values())]
    return any(compare_transcripts(one, order).differs is None for order in orders)


def main() -> None:
    """Draw the pictures, or report the agreement."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--pictures", type=Path, help="folder of pictures for readers")
    given = parser.parse_args()
    drawings = dict(list_drawings(given.data))
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)
        for name, trajectory in drawings.items():
            cv2.imwrite(str(given.pictures / f"{name}.png"), draw_paths(trajectory, (), ""))
        return
    with TABLE.open() as file:
        rows = list(csv.DictReader(file))
    counts = {"reader 1": 0, "reader 2": 0, "either reader": 0, "the readers with each other": 0}
    for row in rows:
        told = transcribe(drawings[row["drawing"]])
        first, second = (parse_strokes(row[f"reader_{number}"]) for number in (1, 2))
        found = agree(told, first), agree(told, second)
        counts["reader 1"] += found[0]
        counts["reader 2"] += found[1]
        counts["either reader"] += any(found)
        counts["the readers with each other"] += agree(first, second)
        if not any(found):
            written = f"{row['reader_1']} | {row['reader_2']}"
            print(f"{row['drawing']:16} {describe_strokes(told)} | {written}")
    for name, count in counts.items():
        print(f"{name:28} {Share(count, len(rows))}")


if __name__ == "__main__":
    main()
