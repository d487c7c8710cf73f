"""Render the sample clips: ``python -m languages.render`` from the repository's root."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, astuple
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from languages.render.body import Array
from languages.render.cast import (
    CLIPS,
    DIVERS,
    POSED_CLIPS,
    SHAPED_CLIPS,
    SIGN_CLIPS,
    TESTS_OF_SIGNS,
    WATERS,
    Clip,
)
from languages.render.encode import encode_within_limit
from languages.render.gestures import DRAWINGS
from languages.render.performance import Performance, move_about, perform, perform_sign
from languages.render.posture import hand_points, pose_body
from languages.render.scene import Scene
from languages.render.signs import SIGNS
from languages.render.water import Bubble, breath

RATE = 25
"""Frames per second of every clip."""

OUTPUT = Path(__file__).resolve().parents[1] / "clips"
OUTPUT_OF_SIGNS = OUTPUT.parent / "signs"


def performance_of(clip: Clip) -> Performance:
    """Compose what the diver does in a clip."""
    if clip.gesture is None:
        return move_about(clip.manner, RATE, clip.seed)
    if clip.is_sign:
        return perform_sign(SIGNS[clip.gesture], clip.manner, RATE, clip.seed)
    return perform(DRAWINGS[clip.gesture], clip.manner, RATE, clip.seed)


def render(clip: Clip) -> tuple[bytes, dict[str, Any]]:
    """Render one clip.

    Returns
    -------
    The MP4 file, and its truth: when which phase lasts, and where the hands' 21 points are.

    """
    performance = performance_of(clip)
    scene = Scene(
        DIVERS[clip.diver],
        WATERS[clip.water],
        clip.view,
        _breaths(performance, clip.seed),
        clip.seed,
    )
    frames = []
    hands: dict[str, list[Any]] = {"L": [], "R": []}
    for number, (motion, right, left) in enumerate(
        zip(performance.body, performance.right, performance.left, strict=True)
    ):
        joints = pose_body(scene.body, motion, right, left)
        frame = scene.render(joints, number / RATE)
        for side, points in hands.items():
            place = scene.pixels(hand_points(scene.body, joints, side))
            points.append(place.round(2).tolist())
            if clip.mittens:
                cover_hand(frame, place, DIVERS[clip.diver].suit.panel)
        frames.append(frame)
    truth = {
        "rate": RATE,
        "phases": [asdict(phase) for phase in performance.phases],
        "right_hand": hands["R"],
        "left_hand": hands["L"],
    }
    return encode_within_limit(frames, RATE), truth


def cover_hand(frame: npt.NDArray[np.uint8], points: Array, colour: Sequence[float]) -> None:
    """Paint a mitten over a hand of ``(21, 2)`` pixels, in place, so that no finger can be seen."""
    hull = cv2.convexHull(np.round(points).astype(np.int32))
    width = max(3, round(0.12 * float(np.ptp(points, axis=0).max())))
    dark = tuple(channel / 2 for channel in colour)
    cv2.polylines(frame, [hull], True, dark, width, cv2.LINE_AA)
    cv2.fillPoly(frame, [hull], dark, cv2.LINE_AA)


def write_phases(path: Path) -> None:
    """Write when the phases of every clip begin and end, in seconds, as JSON."""
    phases = {
        clip.name: [astuple(phase) for phase in performance_of(clip).phases] for clip in CLIPS
    }
    lines = [f"{json.dumps(name)}: {json.dumps(phases[name])}" for name in sorted(phases)]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def _breaths(performance: Performance, seed: int) -> list[Bubble]:
    """Let the diver breathe out every four seconds, as people do at rest."""
    random = np.random.default_rng(seed)
    start = random.uniform(0.0, 1.5)
    ends = np.arange(start, len(performance) / RATE, 4.0)
    return [bubble for end in ends for bubble in breath(random, float(end))]


def main() -> None:
    """Render the clips named on the command line, or all of them."""
    parser = argparse.ArgumentParser(prog="python -m languages.render", description=__doc__)
    parser.add_argument("names", nargs="*", help="clips without suffix; all that are kept if none")
    parser.add_argument("--out", type=Path, help="folder for the clips")
    parser.add_argument("--truth", type=Path, help="folder for where the hands truly are, as JSON")
    arguments = parser.parse_args()
    every = (*CLIPS, *POSED_CLIPS, *SIGN_CLIPS, *TESTS_OF_SIGNS, *SHAPED_CLIPS)
    known = {clip.name: clip for clip in every}
    if unknown := set(arguments.names) - known.keys():
        parser.error(
            f"no clip is called {', '.join(sorted(unknown))}; see languages/render/cast.py"
        )
    chosen = [known[name] for name in arguments.names] or [*CLIPS, *SIGN_CLIPS]
    if arguments.out is None:
        write_phases(OUTPUT / "phases.json")
    for clip in chosen:
        file, truth = render(clip)
        folder = arguments.out or (OUTPUT_OF_SIGNS if clip.is_sign else OUTPUT)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{clip.name}.mp4").write_bytes(file)
        if arguments.truth:
            arguments.truth.mkdir(parents=True, exist_ok=True)
            (arguments.truth / f"{clip.name}.json").write_text(json.dumps(truth))
        print(
            f"{clip.name}: {len(file) / 1000:.0f} kB, {len(truth['right_hand'])} frames", flush=True
        )


if __name__ == "__main__":
    main()
