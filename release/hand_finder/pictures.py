"""Pictures with boxed hands: a folder with `images/` and `boxes.csv`.

Rows of `boxes.csv`: image, what, x0, y0, x1, y1 and, where they are known, x and y of the wrist and
of the middle finger's knuckle, all in pixels. What is ``Hand``, or ``Unclear`` where nothing is
taught; other rows only say that the picture is there. Any tool that boxes photographs can write it.
Beside drawn stills lies `joints.npz`, with the joints of all hands (`read_joints`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

EDGES = ("x0", "y0", "x1", "y1")
JOINTS = ("wrist_x", "wrist_y", "knuckle_x", "knuckle_y")
LONGEST_SIDE = 640
"""Pixels to which a picture is made smaller before it teaches."""


@dataclass(frozen=True)
class Picture:
    """A picture and what is boxed in it.

    Attributes
    ----------
    image
        ``(height, width, 3)`` RGB, its longer side `LONGEST_SIDE` at most.
    hands, unclear
        ``(N, 8)`` left, top, right, bottom, wrist and knuckle in pixels; NaN where not known.

    """

    image: npt.NDArray[np.uint8]
    hands: npt.NDArray[np.float64]
    unclear: npt.NDArray[np.float64]


@dataclass(frozen=True)
class Hands:
    """A drawn still and the joints of the diver's two hands.

    Attributes
    ----------
    image
        ``(height, width, 3)`` RGB.
    joints
        ``(2, 21, 2)`` pixels of the left and the right hand.
    seen
        ``(2,)`` share of each that is seen.

    """

    image: npt.NDArray[np.uint8]
    joints: npt.NDArray[np.float64]
    seen: npt.NDArray[np.float64]


def write_pictures(folder: Path, seeds: Iterable[int], salutes: float = 0.0) -> None:
    """Draw the stills of each seed into a folder; its table grows with every picture."""
    # Only who draws stills needs the renderer.
    from release.hand_finder.stills import draw_stills

    (folder / "images").mkdir(parents=True, exist_ok=True)
    names, joints, shares = [], [], []
    with (folder / "boxes.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("image", "what", *EDGES, *JOINTS))
        for seed in seeds:
            for number, still in enumerate(draw_stills(seed, salutes)):
                name = f"diver{seed:05}_{number}.jpg"
                names.append(name)
                joints.append(still.joints)
                shares.append(still.seen)
                bgr = cv2.cvtColor(still.image, cv2.COLOR_RGB2BGR)
                cv2.imwrite(str(folder / "images" / name), bgr, [cv2.IMWRITE_JPEG_QUALITY, 92])
                table.writerow((name, "Picture", 0, 0, 0, 0))
                for what, boxes in (("Hand", still.hands), ("Unclear", still.unclear)):
                    table.writerows((name, what, *box.round(1).tolist()) for box in boxes)
            file.flush()
    np.savez(folder / "joints.npz", names=names, joints=joints, seen=shares)


def read_joints(folder: Path) -> list[Hands]:
    """Return the drawn stills of a folder with the joints of their hands, in the order drawn."""
    with np.load(folder / "joints.npz") as kept:
        rows = zip(kept["names"].tolist(), kept["joints"], kept["seen"], strict=True)
        return [Hands(read_rgb(folder / "images" / name), *row) for name, *row in rows]


def read_pictures(folder: Path, without: Sequence[str] = ()) -> list[Picture]:
    """Return the pictures of a folder, without those whose names begin with one of `without`."""
    return [
        _read(folder / "images" / name, kinds["Hand"], kinds["Unclear"])
        for name, kinds in read_boxes(folder).items()
        if not name.startswith(tuple(without))
    ]


def read_boxes(folder: Path) -> dict[str, dict[str, npt.NDArray[np.float64]]]:
    """Return the boxes of a folder's pictures by name, which are sorted, and by kind.

    ``Hand`` and ``Unclear`` are there for each: ``(N, 8)`` as in `Picture`, in its own pixels.
    """
    boxes: dict[str, dict[str, list[list[float]]]] = {}
    with (folder / "boxes.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            kinds = boxes.setdefault(row["image"], {"Hand": [], "Unclear": []})
            if row["what"] in kinds:
                kinds[row["what"]].append(
                    [float(row.get(edge) or "nan") for edge in (*EDGES, *JOINTS)]
                )
    return {
        name: {kind: np.array(rows).reshape(-1, 8) for kind, rows in kinds.items()}
        for name, kinds in sorted(boxes.items())
    }


def read_rgb(path: Path) -> npt.NDArray[np.uint8]:
    """Read a picture as RGB, ``(height, width, 3)``.

    Raises
    ------
    FileNotFoundError
        When there is none, or it is no picture.

    """
    bgr = cv2.imread(str(path))
    if bgr is None:
        raise FileNotFoundError(f"{path} is no picture")
    return np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB), np.uint8)


def _read(path: Path, hands: npt.NDArray[np.float64], unclear: npt.NDArray[np.float64]) -> Picture:
    image = read_rgb(path)
    scale = min(LONGEST_SIDE / max(image.shape[:2]), 1.0)
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return Picture(np.asarray(small, np.uint8), hands * scale, unclear * scale)
