"""Tasks: the work of worker processes, one class for each kind, with its words for failure.

A new kind is one more class in `AnyTask`; a route runs it by `app.api.jobs.job.run_task`.
"""

from __future__ import annotations

import base64
import contextlib
import errno
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict
from functools import cache, lru_cache
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import cv2
import numpy as np
from pydantic import BaseModel, Field, TypeAdapter

from app.api.workers.executor import TaskFiles
from app.api.workers.pictures import Poster, Thumbnails, first_picture, write_poster
from app.api.workers.task import READS, WRITES, Reads, Report, Task, Writes, failure_of
from app.api.workers.worker_messages import (
    Answered,
    Failed,
    Finished,
    Probed,
    Progressed,
    RecognizedTake,
)
from app.bags.export_writer import NamedRecognition, write_bag
from app.clip_sources import (
    VIDEO,
    ClipSource,
    ReadOptions,
    UnsupportedFile,
    source_named,
)
from app.recognition import Language, OsgError, Recognizer, Recording
from app.recognition.errors import LanguageError, ModelError, VideoError
from app.recognition.estimation.factory import create_estimator
from app.recognition.health.check import check_health
from app.recognition.language.export_format import from_reference, is_reference
from app.recognition.language.file_schema import TriggerEntry, entry_to_trigger
from app.recognition.language.requirements import require_seen_landmarks
from app.recognition.poses.frame import Body, FrameLandmarks, pose_in
from app.recognition.recording.chapters import join_chapters
from app.recognition.recording.clip_range import find_clip_range
from app.recognition.recording.video import VideoFrame, read_frames
from app.recognition.recording.video import probe as probe_video
from app.resources import known_signs_file

PROGRESS_SECONDS = 0.1
"""Shortest time in seconds between two reports: as fast as an eye follows a progress bar."""

REPORT_EVERY = 8
"""Steps of a check between two reports, each some ten milliseconds: ten reports a second."""

PREPARATION_SECONDS = 600.0
"""Most seconds without a report while the recogniser of a language is prepared."""


class _ClipTask(Task):
    """Work on a received file, which its source reads."""

    source: str
    file: Reads
    options: ReadOptions = ReadOptions()
    # For every kind of file: while landmarks are found, the part that crashes is the decoder.
    broken_off: Failed = failure_of(VIDEO.broken_off)
    hung: Failed | None = Failed(
        code="decoder",
        detail="the process that read this clip made no progress and was ended; "
        "convert it to an MP4 with H.264 and try again",
    )

    @property
    def reader(self) -> ClipSource:
        return source_named(self.source)

    def refuse(self, error: Exception) -> Failed:
        match error:
            case MemoryError() | OSError(errno=errno.EFBIG):
                what = "memory" if isinstance(error, MemoryError) else "room on the disk"
                detail = f"the clip needs more {what} than a job may use"
                return Failed(code="decoder", detail=detail)
            case UnsupportedFile():
                return Failed(code="unsupported_media_type", detail=str(error))
            case OsgError() if not isinstance(error, ModelError | LanguageError):
                return failure_of(self.reader.refuse(error, self.file))
        return super().refuse(error)


class Probe(_ClipTask):
    """Reports the facts that a received file states about itself, and the first frame of a video.

    A process that dies may have been killed from outside, for example for lack of memory: the file
    is refused only if it happens twice. The sender waits, and the file may be only here.
    """

    queue, here, tries = "short", True, 2

    kind: Literal["probe"] = "probe"

    def run(self, report: Report) -> None:
        """Report a `Probed`; see `ClipSource.probe`."""
        facts = asdict(self.reader.probe(self.file, self.options))
        # Of a dive recording, a picture would mean to read all of it again.
        picture = first_picture(self.file) if self.source == VIDEO.name else None
        encoded = None if picture is None else base64.b64encode(picture)
        report(Probed.model_validate({**facts, "picture": encoded}))


class Join(_ClipTask):
    """Joins a camera's chapters, which follow each other in the received file, to one video."""

    queue, here = "short", True

    kind: Literal["join"] = "join"
    source: str = VIDEO.name
    chapters: tuple[int, ...]
    target: Writes

    def run(self, report: Report) -> None:
        """Write the video; see `join_chapters`."""
        if sum(self.chapters) != self.file.stat().st_size:
            raise VideoError("the clip is not as long as the chapters that it is said to hold")
        ranges = pairwise([0, *accumulate(self.chapters)])
        join_chapters([(self.file, each) for each in ranges], self.target)
        report(Finished())


class Record(_ClipTask):
    """Writes a clip's recording, poster, filmstrip and, of what is no video, the video.

    Of a video, `so_far` is written now and then with the frames until then.
    With `known`, the recording of a sample clip that comes with the program, no models run.
    """

    kind: Literal["record"] = "record"
    known: Annotated[Path | None, READS] = None
    video: Annotated[Path | None, WRITES] = None
    so_far: Annotated[Path | None, WRITES] = None
    recording: Writes
    poster: Writes
    filmstrip: Writes

    def run(self, report: Report) -> None:
        """Report the frames with the newest pose; see `ClipSource.record`."""
        # On another machine the program may lie elsewhere.
        if self.known is not None and self.known.is_file():
            return self._keep_known(self.known, report)
        steps, thumbnails, poster = _Steps(report, "poses"), Thumbnails(), Poster(self.poster)
        partial = None if self.video is None else self.video.with_suffix(".part")
        if partial is None:
            # First, so that the clip's card has a picture early.
            write_poster(self.file, self.poster)

        def observe(frame: VideoFrame, found: FrameLandmarks) -> None:
            steps.newest = frame, found.body
            thumbnails.add(frame.index, frame.image)
            if partial is not None:
                poster.add(frame.time, frame.image)

        def keep(recording: Recording) -> None:
            assert self.so_far is not None
            recording.save(self.so_far)
            steps.kept += 1

        recorded = self.reader.record(
            self.file,
            self.options,
            video=partial,
            progress=steps.progress,
            observer=observe,
            keep_so_far=None if self.so_far is None else keep,
        )
        if partial is not None and self.video is not None:
            partial.replace(self.video)
        poster.write()
        thumbnails.write(self.filmstrip)
        _save(recorded.recording, self.recording, report)
        return None

    def _keep_known(self, known: Path, report: Report) -> None:
        recording, thumbnails = Recording.load(known), Thumbnails()
        write_poster(self.file, self.poster)
        with read_frames(self.file) as frames:
            for frame in frames:
                thumbnails.add(frame.index, frame.image)
        thumbnails.write(self.filmstrip)
        _save(recording, self.recording, report)


class FindLandmarks(_ClipTask):
    """Writes only a clip's recording, with `threads` for the models of one of several processes."""

    kind: Literal["landmarks"] = "landmarks"
    recording: Writes
    threads: int

    def run(self, report: Report) -> None:
        """Report the frames."""
        cv2.setNumThreads(self.threads)
        with closing(create_estimator(threads=self.threads)) as estimator:
            progress = _Steps(report, "poses").progress
            found = self.reader.record(
                self.file, self.options, estimator=estimator, progress=progress
            )
        _save(found.recording, self.recording, report)


class Export(Task):
    """Writes a clip and its recognitions as MCAP to `target`; `trigger` cuts its takes."""

    queue = "short"
    unusable = "video_unreadable"

    kind: Literal["session"] = "session"
    broken_off: Failed = Failed(
        code="decoder",
        detail="the process that wrote it broke off: the clip is damaged, or it needs more memory "
        "or time than a job may use; try again, or cut out the part with the gestures",
    )
    clip: str
    video: Reads
    recording: Reads
    target: Writes
    recognitions: tuple[NamedRecognition, ...]
    trigger: TriggerEntry | None = None

    def run(self, report: Report) -> None:
        """Report the frames."""
        recording = Recording.load(self.recording)
        video: Path | None = None
        with contextlib.suppress(VideoError):
            probe_video(self.video)
            video = self.video
        write_bag(
            self.target,
            recording,
            self.recognitions,
            video=video,
            name=self.clip,
            trigger=entry_to_trigger(self.trigger),
            progress=_Steps(report, "saving").progress,
        )
        report(Finished(frames=len(recording.poses)))


_TOO_LARGE = Failed(
    code="language_too_large",
    detail="this language takes more time or memory than one job may use; "
    "split it into languages with fewer gestures",
)


class ImportedLanguage(BaseModel):
    """A language file that was read: values in it, and the same language in our own format.

    `change` describes the import, for the history.
    """

    name: str
    author: str
    labels: list[str]
    revision: int
    change: str
    document: str


def read_language(content: bytes, name: str) -> ImportedLanguage:
    """Read a language file in our format, or in the published implementation's, then named `name`.

    Raises
    ------
    LanguageError
        When the file is neither.

    """
    if is_reference(content):
        language, change = from_reference(content, name), "Import of an osg-reference file"
    else:
        language, change = Language.from_json(content), "Import"
    return ImportedLanguage(
        name=language.name,
        author=language.author,
        labels=list(language.labels),
        revision=language.revision,
        change=change,
        document=language.to_json(),
    )


class Import(Task):
    """Reads a language file, named `name` if it has no name; the sender waits, the file is here.

    The largest one allowed takes a minute.
    """

    queue, here, cpu_seconds = "short", True, 120

    kind: Literal["import"] = "import"
    silence_seconds: float | None = 120
    broken_off: Failed = _TOO_LARGE
    file: Reads
    name: str

    def run(self, report: Report) -> None:
        """Report an `ImportedLanguage` as the result."""
        found = read_language(self.file.read_bytes(), self.name)
        report(Finished(result=found.model_dump()))


class Check(Task):
    """Checks a language; one of twenty gestures takes twenty seconds, one of a thousand minutes."""

    queue, cpu_seconds = "long", 1800

    kind: Literal["check"] = "check"
    silence_seconds: float | None = PREPARATION_SECONDS
    broken_off: Failed = _TOO_LARGE
    document: str

    def run(self, report: Report) -> None:
        """Report the health report as the result."""

        def progress(stage: str, done: int, total: int) -> None:
            if done % REPORT_EVERY == 1:
                report(Progressed(stage=stage, done=done, total=total))

        checked = check_health(
            Language.from_json(self.document),
            progress=progress,
            known_signs=Language.load(known_signs_file()),
        )
        report(Finished(result=checked.to_dict()))


class TakeToRecognize(BaseModel):
    """A range of a clip.

    Attributes
    ----------
    recording
        File with the clip's landmarks.
    start, end
        Seconds in the clip.
    keypoints_of
        Name of a clip of received keypoints, which may lack some; None if models found them.
    without
        Label and number of the demonstrations that the take is itself: the language reads it
        without them.

    """

    recording: Path
    start: float
    end: float
    keypoints_of: str | None = None
    without: tuple[tuple[str, int], ...] = ()


class TestRun(Task):
    """Recognises takes by the language file of a revision."""

    __test__: ClassVar[bool] = False
    queue = "long"

    kind: Literal["test"] = "test"
    silence_seconds: float | None = PREPARATION_SECONDS
    broken_off: Failed = Failed(
        code="test_run_broken_off",
        detail="the process that recognises the takes ended or took too long; what is done is "
        "kept, start it again for the rest",
    )
    document: str
    takes: tuple[TakeToRecognize, ...]

    @property
    def files(self) -> TaskFiles:
        """The recordings of the takes."""
        return TaskFiles(tuple(dict.fromkeys(take.recording for take in self.takes)))

    def run(self, report: Report) -> None:
        """Report the answer about each take in order."""
        language = Language.from_json(self.document)
        # Made with the first take: that it cannot be made is the fault of every take.
        recognizer = cache(lambda without: Recognizer(language.without_demonstrations(without)))
        for index, take in enumerate(self.takes):
            try:
                found = _recognize(take, language, recognizer)
            except OsgError as error:
                found = RecognizedTake(start=take.start, end=take.end, fault=str(error))
            report(Answered(index=index, take=found))
            report(Progressed(stage="recognising", done=index + 1, total=len(self.takes)))
        report(Finished())


AnyTask = Probe | Join | Record | FindLandmarks | Export | Import | Check | TestRun
"""Every kind of task, told apart by `kind`."""

TASK: TypeAdapter[AnyTask] = TypeAdapter(Annotated[AnyTask, Field(discriminator="kind")])


class _Steps:
    """Reports the frames of a clip a few times a second, with the body in the newest one."""

    def __init__(self, report: Report, stage: str) -> None:
        self._report, self._stage = report, stage
        self._reported = 0.0
        self.kept = 0
        self.newest: tuple[VideoFrame, Body | None] | None = None

    def progress(self, done: int, total: int) -> None:
        if (now := time.monotonic()) - self._reported < PROGRESS_SECONDS and done != total:
            return
        self._reported = now
        seconds, pose = None, None
        if self.newest is not None:
            frame, body = self.newest
            height, width = frame.image.shape[:2]
            seconds = round(frame.time, 3)
            pose = pose_in(body.xy, width, height) if body else None
        self._report(
            Progressed(
                stage=self._stage,
                done=done,
                total=total,
                time=seconds,
                pose=pose,
                kept=self.kept,
            )
        )


def _save(recorded: Recording, target: Path, report: Report) -> None:
    frames = len(recorded.poses)
    report(Progressed(stage="saving", done=frames, total=frames))
    recorded.save(target)
    time = recorded.poses.time
    report(
        Finished(
            frames=frames,
            seconds=float(time[-1] + np.median(np.diff(time))) if frames > 1 else None,
            warnings=recorded.warnings,
            salute_warnings=recorded.salute_warnings,
        )
    )


def _recognize(
    take: TakeToRecognize,
    language: Language,
    recognizer: Callable[[tuple[tuple[str, int], ...]], Recognizer],
) -> RecognizedTake:
    recording = _load(take.recording)
    if take.keypoints_of is not None:
        require_seen_landmarks(language, recording.poses, take.keypoints_of)
    shown = find_clip_range(recording, take.start, take.end, trigger=language.trigger)
    answer = recognizer(take.without).recognize(shown.poses, shown.unseen).to_dict()
    return RecognizedTake(start=shown.start, end=shown.end, answer=answer)


@lru_cache(1)
def _load(file: Path) -> Recording:
    """Load a recording; the takes of a clip come one after the other."""
    return Recording.load(file)
