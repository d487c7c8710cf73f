"""Small folders in the layout of published sets, with the poses of drawn movements."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from app.evaluation.kept_recordings import kept_recording
from app.recognition import PoseSequence, Recording
from app.recognition.poses.sequence import join_sequences
from app.recognition.recording.video import read_frames
from tests.evaluation.takes import drawn_takes


def write_sdg11(folder: Path, keep: Path) -> None:
    """Write two takes of each of three signs, one in a tank and one in the sea."""
    names = {"left": "LEFT", "right": "BUDDY_UP", "up": "STOP"}
    for number, take in enumerate(drawn_takes("swipes", people=(0,), takes=2)):
        sign, place = names[take.label], ("TANK", "SEA-LOWVIZ")[number % 2]
        name = f"{sign.replace('_', '')}_{place}_VERTICAL_1f8s0f8an{number}.MP4"
        _write_clip(folder / sign / name, take.poses, keep)


def write_scubanet(folder: Path, keep: Path) -> None:
    """Write a clip of each of three signs: nothing said, shown, no sign, shown again."""
    takes = drawn_takes("swipes", people=(0,), takes=2)
    for label in ("left", "right", "up"):
        one, other = (take.poses for take in takes if take.label == label)
        parts = [(None, one), (label.title(), one), ("Idle", other), (label.title(), other)]
        path = folder / "gestures" / f"{label} 1080p GX01.mp4"
        _write_clip(path, _show_in_turn([poses for _, poses in parts]), keep)
        frames = [name for name, poses in parts for _ in range(len(poses))]
        content = {
            "label_version": 1.01,
            "file_name": path.name,
            "frames_total": len(frames),
            "labels": [{"frame": index, "label": name} for index, name in enumerate(frames)],
        }
        path.with_suffix(".json").write_text(json.dumps(content), encoding="utf-8")


def write_caddy(folder: Path, clip: Path) -> None:
    """Write two pictures each of two signs and of none, from a clip; one of them is synthetic."""
    rows = {"positives": [("one", "0"), ("one", "0"), ("two", "0"), ("two", "1")]}
    rows["negatives"] = [("true_negative", "0"), ("true_negative", "0")]
    with read_frames(clip) as frames:
        images = [frame.image for frame, _ in zip(frames, range(6), strict=False)]
    for kind, listed in rows.items():
        table = folder / f"CADDY_gestures_all_true_{kind}_release_v2.csv"
        written = [["scenario", "stereo left", "label name", "synthetic"]]
        for index, (label, synthetic) in enumerate(listed):
            place = f"/genova-A/true_{kind}/raw/genova-A_{index:05d}_left.jpg"
            picture = folder / place.lstrip("/")
            picture.parent.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(picture), cv2.cvtColor(images.pop(0), cv2.COLOR_RGB2BGR))
            written.append(["genova-A", place, label, synthetic])
        with table.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(written)


def _write_clip(path: Path, poses: PoseSequence, keep: Path) -> None:
    """Write a file in place of a clip, and its stored landmarks to a cache folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(path.name.encode())
    recording = Recording(poses=poses, hands=((),) * len(poses), salute=np.zeros(len(poses)))
    keep.mkdir(exist_ok=True)
    recording.save(kept_recording(path, keep))


def _show_in_turn(parts: Sequence[PoseSequence]) -> PoseSequence:
    """Join takes into one recording, a thirtieth of a second apart."""
    joined, end = [], 0.0
    for poses in parts:
        time = poses.time - poses.time[0] + end + 1 / 30
        joined.append(replace(poses, time=time))
        end = float(time[-1])
    return join_sequences(joined)
