"""Render the sample clips: ``python -m languages.render`` from the repository's root."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, astuple, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from languages.render.body import Array
from languages.render.cast import (
    CLIPS,
    DIVERS,
    PAIR_CLIPS,
    POSED_CLIPS,
    SHAPED_CLIPS,
    SIGN_CLIPS,
    TESTS_OF_SIGNS,
    WATERS,
    Buddy,
    Clip,
)
from languages.render.encode import encode_within_limit
from languages.render.gestures import DRAWINGS
from languages.render.hard_cast import HARD_CLIPS
from languages.render.performance import Performance, move_about, perform, perform_sign, stand_by
from languages.render.posture import hand_points, pose_body
from languages.render.scene import WIDTH, Scene
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
    buddies = [_Buddy.of(buddy, clip, number) for number, buddy in enumerate(clip.buddies, 1)]
    buddies.sort(key=lambda buddy: -buddy.distance)
    frames = []
    hands: dict[str, list[Any]] = {"L": [], "R": []}
    first = round(clip.begins * RATE)
    ends = [first + len(performance), *(buddy.last for buddy in buddies)]
    for number in range(max(ends)):
        row = min(max(number - first, 0), len(performance) - 1)
        joints = pose_body(
            scene.body, performance.body[row], performance.right[row], performance.left[row]
        )
        shift = _shift_at(clip.path, number)
        layers = [(buddy.distance, buddy.layer(number)) for buddy in buddies]
        frame = scene.render(
            joints,
            number / RATE,
            shift=shift,
            behind=[layer for distance, layer in layers if distance > clip.view.distance],
            before=[layer for distance, layer in layers if distance <= clip.view.distance],
        )
        for side, points in hands.items():
            place = scene.pixels(hand_points(scene.body, joints, side)) + (shift, 0)
            points.append(place.round(2).tolist())
            if clip.mittens:
                cover_hand(frame, place, DIVERS[clip.diver].suit.panel)
        frames.append(frame)
    truth = {
        "rate": RATE,
        "phases": [
            asdict(replace(phase, start=phase.start + clip.begins, end=phase.end + clip.begins))
            for phase in performance.phases
        ],
        "right_hand": hands["R"],
        "left_hand": hands["L"],
    }
    return encode_within_limit(frames, RATE), truth


class _Buddy:
    """Another diver of a clip, frame by frame."""

    def __init__(self, buddy: Buddy, performance: Performance, scene: Scene, first: int) -> None:
        self._buddy, self._performance, self._scene = buddy, performance, scene
        self._first = first
        self.distance = buddy.view.distance

    @classmethod
    def of(cls, buddy: Buddy, clip: Clip, number: int) -> _Buddy:
        """Prepare the buddy with this number in a clip."""
        seed = 1000 * number + clip.seed
        begins = buddy.begins or 0.0
        if buddy.gesture is None:
            performance, first = stand_by(buddy.manner, RATE, seed, 4.0, buddy.begins), 0
        else:
            performance = perform(DRAWINGS[buddy.gesture], buddy.manner, RATE, seed)
            first = round(begins * RATE)
        scene = Scene(DIVERS[buddy.diver], WATERS[clip.water], buddy.view, [], seed)
        return cls(buddy, performance, scene, first)

    @property
    def last(self) -> int:
        """The number of frames until the gesture ends; 0 for a buddy who stands by."""
        return self._first + len(self._performance) if self._buddy.gesture else 0

    def layer(self, number: int) -> Array:
        """Draw the buddy in a frame of the clip."""
        row = min(max(number - self._first, 0), len(self._performance) - 1)
        made = self._performance
        joints = pose_body(self._scene.body, made.body[row], made.right[row], made.left[row])
        return self._scene.layer(joints, number / RATE, _shift_at(self._buddy.path, number))


def _shift_at(path: Sequence[tuple[float, float]], number: int) -> float:
    """Return how many pixels to the right of the view's place a diver is in a frame."""
    times, shares = zip(*path, strict=True)
    return float(WIDTH * np.interp(number / RATE, times, shares))


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
    signed = (*SIGN_CLIPS, *TESTS_OF_SIGNS)
    every = (*CLIPS, *POSED_CLIPS, *signed, *SHAPED_CLIPS, *PAIR_CLIPS, *HARD_CLIPS)
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
