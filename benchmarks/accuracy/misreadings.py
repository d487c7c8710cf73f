"""Misreadings: whether what an explanation claims of real misread takes is true.

`misreadings.csv` lists takes by other people, and rendered clips whose hands or keypoints cannot be
followed, that commit 8c5da9e5 does not read as what was shown, and 20 takes that were drawn later.
Two readers saw the pictures that ``--pictures`` draws, no sentence of the studio, and wrote down
every cause that they would accept.
A claim is named right if a reader accepts it, false if none does. That two gestures are alike is a
property of the two, not of a take; that a demonstration is odd among the known takes is checked on
takes that the claim did not use: both are counted apart.

    python -m benchmarks.accuracy.misreadings ../shared/data --hard FOLDER [--keep FOLDER]

`FOLDER` holds the rendered clips of `languages.render.hard_cast`:
``python -m languages.render NAME... --out FOLDER``.
"""

from __future__ import annotations

import csv
import re
from argparse import ArgumentParser
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from app.evaluation.labelled_takes import ClipRecorder
from app.evaluation.share import Share
from app.recognition import Gesture, Language, OsgError, PoseSequence, Recognizer, Recording
from app.recognition.explanation.context import KnownTake, KnownTakes, RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recording.clip_range import find_clip_range
from app.recognition.recording.extraction import explain_missing_salutes
from app.recognition.recording.segmentation import takes_in
from benchmarks.accuracy.misreading_pictures import draw_bodies, draw_clip, draw_paths
from benchmarks.accuracy.people import define
from benchmarks.sets.every_set import all_sets
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet

TABLE: Final = Path(__file__).with_suffix(".csv")
"""Columns: take, expected, read_as (empty: asked back or refused; "no take"), reader_1, reader_2:
accepted causes, separated by blanks."""

SETS: Final = {"digits": 5, "letters": 3, "utd_signals": 10, "utd_other": 6, "utkinect": 6}
"""Sets of several people, and the most takes that are listed of each."""

DRAWS, QUERIES, SEEDS = 3, 40, (50, 51)
"""Draws of each seed; takes of the second one were listed and read once the rules stood."""

SAMPLES: Final = Path("languages")
NO_TAKE: Final = "no take"


@dataclass(frozen=True, eq=False)
class Shown:
    """A take, or a clip without one, and the language that should have read it.

    Attributes
    ----------
    name
        Folder and file, or set, draw and number of the recording.
    expected
        The gesture that was shown.
    recognizer
        Of the language.
    context
        The take; None: no take was found.
    recording
        Of a clip; None for a recorded set.

    """

    name: str
    expected: str
    recognizer: Recognizer
    context: RecognitionContext | None
    recording: Recording | None

    @property
    def read_as(self) -> str:
        """What the take is read as; empty if as nothing."""
        return NO_TAKE if self.context is None else self.context.result.label or ""


class Takes:
    """Finds the takes of the table in the data.

    Parameters
    ----------
    data
        Folder of the recordings by other people.
    hard
        Folder of the rendered clips.
    recorder
        Reads clips.

    """

    def __init__(self, data: Path, hard: Path, recorder: ClipRecorder) -> None:
        self._folders = {
            "rendered_letters": data / "rendered_letters",
            "strokes": data / "strokes",
            "samples": SAMPLES / "clips",
            "hard": hard,
        }
        self._trajectories, self._recorder = data / "trajectories", recorder

    def find(self, name: str) -> Shown:
        """Return a take of the table."""
        folder, _, rest = name.partition("/")
        if folder in self._folders:
            return self._find_clip(folder, rest)
        number, _, index = rest.partition("/")
        return self._find_recorded(folder, int(number), int(index))

    def _find_clip(self, folder: str, name: str) -> Shown:
        recording = self._recorder.record(self._folders[folder] / f"{name}.mp4")
        recognizer = self._languages(folder)
        takes = list(takes_in(recording))
        context = RecognitionContext.of_take(recognizer, takes[0]) if takes else None
        return Shown(f"{folder}/{name}", _expected_of(name), recognizer, context, recording)

    def path_of(self, name: str) -> Path | None:
        """Return the file of a clip; None for a recorded set."""
        folder, _, rest = name.partition("/")
        return self._folders[folder] / f"{rest}.mp4" if folder in self._folders else None

    def list_clips(self) -> Iterator[Shown]:
        """Yield the takes of all clips but the demonstrations."""
        for folder, path in self._folders.items():
            for clip in sorted(path.glob("*.mp4")):
                if "demo" not in clip.stem and clip.stem != "ordinary-movement":
                    yield self._find_clip(folder, clip.stem)

    @cache  # noqa: B019
    def list_known(self, name: str) -> tuple[KnownTake, ...]:
        """Return the other takes of a take's language, which a team would have in its test set."""
        folder, _, rest = name.partition("/")
        if folder not in self._folders:
            number, _, own = rest.partition("/")
            recorded, (recognizer, queries) = self._set(folder), self._drawn(folder)[int(number)]
            takes = [
                (str(recorded.labels[each]), recorded.recordings[each])
                for each in queries
                if each != int(own)
            ]
            return tuple(_list_queries(recognizer, takes))
        recognizer, found = self._languages(folder), []
        kept = "samples" if folder == "hard" else folder
        for clip in sorted(self._folders[kept].glob("*.mp4")):
            if clip.stem != rest and "demo" not in clip.stem and _is_test(clip.stem):
                poses = [take.poses for take in takes_in(self._recorder.record(clip))]
                found += [(_expected_of(clip.stem), each) for each in poses]
        return tuple(_list_queries(recognizer, found))

    def is_odd(self, name: str) -> bool:
        """Return whether the demonstration of a take's gesture is worse than takes by others.

        Known takes take its place one after the other; takes of the gesture that were not drawn
        are read. It is if with more than half of them more of these are right.
        """
        folder, _, rest = name.partition("/")
        if folder in self._folders:
            return False
        recorded, shown = self._set(folder), self.find(name)
        language, label = shown.recognizer.language, shown.expected
        _, drawn = self._drawn(folder)[int(rest.split("/")[0])]
        own = np.flatnonzero(recorded.labels == label).tolist()
        unseen = [(label, recorded.recordings[each]) for each in own if each not in drawn][:40]

        def count(recognizer: Recognizer) -> int:
            return sum(read == label for read in KnownTakes(recognizer, queries).readings)

        queries = list(_list_queries(shown.recognizer, unseen))
        before, after = count(shown.recognizer), []
        for each in own:
            if each in drawn and each != int(rest.split("/")[1]):
                changed = language.with_changed(define(recorded, [each]))
                after.append(count(Recognizer(changed, "full")))
        return bool(after) and float(np.median(after)) > before

    @cache  # noqa: B019
    def _languages(self, folder: str) -> Recognizer:
        if folder in ("samples", "hard"):
            return Recognizer(Language.load(SAMPLES / "osg-table-2.json"))
        gestures = [
            Gesture.from_demonstration(
                clip.stem.removesuffix("_demo"),
                find_clip_range(self._recorder.record(clip)).poses,
            )
            for clip in sorted(self._folders[folder].glob("*_demo.mp4"))
        ]
        return Recognizer(Language(folder, gestures), "full")

    @cache  # noqa: B019
    def _set(self, name: str) -> RecordedSet:
        return next(all_sets(self._trajectories, [name]))

    @cache  # noqa: B019
    def _drawn(self, name: str) -> list[tuple[Recognizer, list[int]]]:
        recorded = self._set(name)
        return [
            (
                Recognizer(Language(name, demonstrated(recorded, draw.templates)), "full"),
                draw.others.tolist(),
            )
            for seed in SEEDS
            for draw in draws(recorded, DRAWS, QUERIES, seed)
        ]

    def _find_recorded(self, name: str, number: int, index: int) -> Shown:
        recorded, (recognizer, _) = self._set(name), self._drawn(name)[number]
        poses = recorded.recordings[index]
        context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
        label = str(recorded.labels[index])
        return Shown(f"{name}/{number}/{index}", label, recognizer, context, None)

    def list_recorded(self) -> Iterator[Shown]:
        """Yield misread takes of the sets, one of each person and gesture."""
        for name, most in SETS.items():
            recorded, seen = self._set(name), set[tuple[str, str]]()
            for number, (_, queries) in enumerate(self._drawn(name)[:DRAWS]):
                for index in queries:
                    key = str(recorded.people[index]), str(recorded.labels[index])
                    shown = self._find_recorded(name, number, index)
                    if key not in seen and len(seen) < most and _is_misread(shown):
                        seen.add(key)
                        yield shown


def _expected_of(name: str) -> str:
    """Return the gesture that a clip shows, by its name."""
    return "triangle" if name == "unfinished-triangle" else re.split("[-_]", name)[0]


def _is_test(name: str) -> bool:
    return name not in ("ordinary-movement", "unfinished-triangle")


def _list_queries(
    recognizer: Recognizer, takes: Sequence[tuple[str, PoseSequence]]
) -> Iterator[KnownTake]:
    for label, poses in takes:
        with suppress(OsgError):
            yield KnownTake(label, recognizer.query(poses))


def _is_misread(shown: Shown) -> bool:
    try:
        return shown.read_as != shown.expected
    except OsgError:
        return False


def list_misread(takes: Takes) -> None:
    """Write the table without the readers' columns."""
    rows = [
        (shown.name, shown.expected, shown.read_as)
        for shown in (*takes.list_clips(), *takes.list_recorded())
        if _is_misread(shown)
    ]
    with TABLE.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("take", "expected", "read_as", "reader_1", "reader_2"))
        writer.writerows((*row, "", "") for row in rows)
    print(f"{len(rows)} misread takes", dict(Counter(row[0].split("/")[0] for row in rows)))


def draw_pictures(takes: Takes, folder: Path) -> None:
    """Draw a picture of every take of the table, named by its row."""
    folder.mkdir(parents=True, exist_ok=True)
    with TABLE.open() as file:
        names = [row["take"] for row in csv.DictReader(file)]
    for name in names:
        shown = takes.find(name)
        gestures = {each.label: each for each in shown.recognizer.language.gestures}
        panels = []
        context, expected = shown.context, gestures[shown.expected]
        title = f"{shown.expected}: its demonstration"
        panels.append(draw_paths(expected.trajectory, expected.salient, title))
        raw = None if context is None else Trajectory.from_poses(context.poses)
        panels.append(draw_paths(raw, expected.salient, f"the take, meant as {shown.expected}"))
        if context is not None:
            result = context.result
            other = result.nearest if result.nearest != shown.expected else result.runner_up
            near = gestures[other or shown.expected]
            read = result.label or (" or ".join(result.between) if result.between else "refused")
            title = f"{near.label}: its demonstration (read as: {read})"
            panels.append(draw_paths(near.trajectory, near.salient, title))
        else:
            panels.append(draw_paths(None, (), "no take was found"))
        path = takes.path_of(name)
        if shown.recording is not None and path is not None:
            below = draw_clip(path, shown.recording)
        else:
            assert context is not None
            below = draw_bodies(context.poses)
        picture = np.concatenate([np.concatenate(panels, axis=1), below])
        cv2.imwrite(str(folder / f"{name.replace('/', ' ')}.png"), picture)


def find_claim(takes: Takes, name: str) -> str:
    """Return the kind of the cause that the sentence of a take claims; empty: none."""
    shown = takes.find(name)
    if shown.context is None:
        assert shown.recording is not None
        return claim_of_absence(shown.recording)
    context = replace(shown.context, known=takes.list_known(name))
    why = explain(context, shown.expected)
    return why.causes[0].kind.value if why.causes else ""


def claim_of_absence(recording: Recording) -> str:
    """Return what is claimed of a clip without a take: a salute or hands not seen, or a turn."""
    why = explain_missing_salutes(recording.poses, recording.salute, recording.hands)
    claims = {
        "the first salute was": "second_salute",
        "the second salute was": "first_salute",
        "degrees away": "turned_away",
        "no hand in": "no_hand",
        "outside of the picture": "not_seen",
        "hands seen in": "no_hand",
    }
    told = next(why, "")
    return next((claim for words, claim in claims.items() if words in told), "")


def measure_claims(takes: Takes) -> None:
    """Print what is claimed of every take, and how many claims are true, false, or not made.

    Changed are takes that are read right by now, and takes found in clips of which the readers saw
    that none was found.
    """
    counts: Counter[str] = Counter()
    with TABLE.open() as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        accepted = {*row["reader_1"].split(), *row["reader_2"].split()}
        claim = find_claim(takes, row["take"])
        found = "named" if claim in accepted else "false" if claim else "silent"
        shown = takes.find(row["take"])
        if not _is_misread(shown) or (row["read_as"] == NO_TAKE) != (shown.context is None):
            found = "changed"
        elif claim == "near_gesture":
            found = "alike"
        elif claim == "demonstration" and found == "false" and takes.is_odd(row["take"]):
            found = "odd"
        counts[found] += 1
        print(f"{row['take']:28} {claim:18} {found:8} {sorted(accepted)}", flush=True)
    for found in ("named", "odd", "alike", "false", "silent", "changed"):
        print(f"{found:8} {Share(counts[found], len(rows))} n {counts[found]} of {len(rows)}")


def main() -> None:
    """List the takes, draw their pictures, or measure the claims."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--hard", type=Path, required=True, help="rendered clips")
    parser.add_argument("--keep", type=Path, help="cache folder of what is found in clips")
    parser.add_argument("--list", action="store_true", help="write the table anew")
    parser.add_argument("--pictures", type=Path, help="folder of pictures for readers")
    given = parser.parse_args()
    with closing(ClipRecorder(given.keep)) as recorder:
        takes = Takes(given.data, given.hard, recorder)
        if given.list:
            list_misread(takes)
        elif given.pictures:
            draw_pictures(takes, given.pictures)
        else:
            measure_claims(takes)


if __name__ == "__main__":
    main()
