"""SLEAP reader: projects and predictions (.slp) and analysis (.h5), by SLEAP's own library."""

from __future__ import annotations

import importlib
import json
import warnings
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.keypoint_files.keypoint_people import Person, table_of_people, tell_track
from app.keypoint_files.keypoint_table import (
    MALFORMED,
    MOST_PEOPLE,
    Facts,
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
    mask_unseen,
)
from app.keypoint_files.self_contained import require_self_contained
from app.recognition.errors import KeypointFileError, OsgError, explain_missing_package
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.people import prominence_over
from app.recognition.recording.video_limits import VideoLimits


def read_sleap(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read the first video of a file; see `app.keypoint_files.read_keypoints`.

    Of several tracks the most prominent is taken. Without tracks the instances are joined from
    frame to frame, and the most prominent person over the file is taken.

    Raises
    ------
    KeypointFileError
        When `sleap-io` is not installed, or the file cannot be read.

    """
    labels = _labels(path, limits)
    if isinstance(labels, KeypointTable):
        return labels
    try:
        return _table(labels, path, options, limits)
    except MALFORMED as error:  # the library checks little of what it reads
        raise _unreadable(path, error) from error


def _table(labels: Any, path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Return the keypoints of the first video."""
    names = tuple(str(name) for name in labels.skeleton.node_names)
    labelled = sorted(
        labels.find(labels.videos[0]) if labels.videos else labels.labeled_frames,
        key=lambda frame: int(frame.frame_idx),
    )
    limits.require_frames(len(labelled))
    if not labelled:
        raise KeypointFileError(f"{path} has no labelled frame; give a file with predictions")
    frames = np.array([int(frame.frame_idx) for frame in labelled], dtype=np.float64)
    tracks = list(labels.tracks)
    track: Any = _most_prominent(labelled, tracks) if tracks else None
    everybody = [
        [Person(_points(each)) for each in frame.instances if not tracks or each.track is track]
        for frame in labelled
    ]
    times = Times(frames, counted=True)
    facts = Facts(frame_size=_size(labels), notes=())
    if tracks:
        facts["notes"] = tell_track(len(tracks), track.name)
        facts["people"] = np.array([_count_tracks(frame) for frame in labelled])
    if len(labels.videos) > 1:
        facts["notes"] += (f"the file holds {len(labels.videos)} videos; the first is read",)
    return table_of_people(everybody, times, path, options, names=names, **facts)


def _labels(path: Path, limits: VideoLimits) -> Any:
    """Return the labels that SLEAP's library reads from a file, after a check of the file.

    An analysis without scores, as SLEAP wrote it before 1.1.4, is read here into a table.
    """
    try:
        with explain_missing_package(str(path), "keypoints", KeypointFileError):
            library, h5py = (importlib.import_module(name) for name in ("sleap_io", "h5py"))
        require_self_contained(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about videos that are missing but not needed
            with h5py.File(path) as file:
                _require_frames(file, limits)
                if "tracks" in file and "point_scores" not in file:
                    return _table_without_scores(file)
                stated = json.loads(file.attrs.get("video_backend_metadata", "{}"))
            if path.suffix.lower() == ".slp":
                return library.load_slp(str(path), open_videos=False)
            # Else the library opens the file or address that it finds as the video's name.
            video = library.Video("", backend_metadata=dict(stated), open_backend=False)
            return library.load_analysis_h5(str(path), video=video)
    except OsgError:
        raise
    except Exception as error:  # the library's errors share no base but Exception
        raise _unreadable(path, error) from error


def _table_without_scores(file: Any) -> KeypointTable:
    """Return the most prominent track of an open analysis; every point in it counts as sure."""
    names = tuple(name.decode() for name in file["node_names"][:])
    tracks = np.asarray(file["tracks"][:], dtype=np.float64)
    if tracks.ndim != 4 or tracks.shape[1:3] != (2, len(names)) or 0 in tracks.shape:
        raise ValueError(f"tracks of shape {tracks.shape} for {len(names)} nodes")
    xy = tracks.transpose(0, 3, 2, 1)
    chosen = max(range(len(xy)), key=lambda track: prominence_over(xy[track]))
    named = [name.decode() for name in file.get("track_names", [])[:]]
    name = named[chosen] if chosen < len(named) else str(chosen)
    return KeypointTable(
        names=names,
        xy=mask_unseen(xy[chosen], None),
        times=Times(np.arange(xy.shape[1], dtype=np.float64), counted=True),
        notes=tell_track(len(xy), name),
        people=np.asarray(np.isfinite(xy).all(axis=3)).any(axis=2).sum(axis=0, dtype=np.int64),
    )


def _unreadable(path: Path, error: Exception) -> KeypointFileError:
    reason = " ".join(str(error).split())
    return KeypointFileError(
        f"{path} cannot be read as SLEAP's ({type(error).__name__}: {reason}); give a .slp file"
        f" or SLEAP's analysis export. DeepLabCut's .h5 is refused, for it holds code: convert"
        f" it with deeplabcut.analyze_videos_converth5_to_csv"
    )


def _require_frames(file: Any, limits: VideoLimits) -> None:
    """Refuse too many frames and people by the shapes of their tables, before these are read."""
    if "tracks" in file:
        limits.require_frames(max(file["tracks"].shape, default=0))
    rows = max(len(file[name]) for name in ("frames", "instances", "node_names") if name in file)
    if rows > MOST_PEOPLE * limits.frames:
        raise KeypointFileError(
            f"the file has tables of {rows} rows, more than {MOST_PEOPLE} people in every frame; "
            "export the video with the gestures alone"
        )


def _points(instance: Any) -> FloatArray:
    """Return ``(K, 3)`` x, y and score of an instance; points labelled by a person have score 1."""
    points = np.asarray(instance.numpy(), dtype=np.float64)[:, :2]
    stored = instance.points
    score = np.ones(len(points))
    if "score" in (stored.dtype.names or ()):
        score = np.nan_to_num(np.asarray(stored["score"], dtype=np.float64))
    return np.column_stack([points, score])


def _most_prominent(labelled: list[Any], tracks: list[Any]) -> Any:
    """Return the most prominent track; there may be thousands of short ones."""
    points: dict[int, list[FloatArray]] = {id(track): [] for track in tracks}
    for frame in labelled:
        for instance in frame.instances:
            if id(instance.track) in points:
                points[id(instance.track)].append(_points(instance))
    return max(tracks, key=lambda track: _measure_prominence(points[id(track)]))


def _measure_prominence(points: list[FloatArray]) -> float:
    if not points:
        return 0.0
    stacked = np.stack(points)
    return prominence_over(stacked[..., :2], np.nan_to_num(stacked[..., 2]))


def _count_tracks(frame: Any) -> int:
    return len({id(instance.track) for instance in frame.instances if instance.track})


def _size(labels: Any) -> tuple[int, int] | None:
    """Return width and height of the video if the file states them."""
    shape = labels.videos[0].shape if labels.videos else None
    if shape is None or not shape[1] or not shape[2]:
        return None
    return int(shape[2]), int(shape[1])


SLEAP: Final = KeypointFormat(
    (".h5", ".slp", ".hdf5"), lambda head: head.startswith(b"\x89HDF\r\n\x1a\n"), read_sleap
)
"""Both of SLEAP's kinds of files are HDF5."""
