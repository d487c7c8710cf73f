"""Takes of clips: those between triggers, and those that are demonstrations, with their faults."""

from __future__ import annotations

import hashlib
import json
import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TypeVar

from app.api.http.schemas.clips import TakeView
from app.api.http.schemas.gestures import (
    DemonstrationFaultView,
    GestureTrial,
    NewDemonstration,
    SourceView,
)
from app.api.http.schemas.values import NONE_EXPECTED
from app.api.services.recording_cache import (
    RecordingFile,
    load_recording,
    recording_file,
    recording_of,
    whole_recording,
)
from app.api.services.stored_languages import language_of
from app.recognition import Gesture, Language, OsgError, Recognizer
from app.recognition.explanation.demonstration_faults import (
    ClipOutline,
    DemonstrationFault,
    find_demonstration_faults,
)
from app.recognition.recording.clip_range import ClipRange
from app.recognition.recording.segmentation import find_brackets, takes_in
from app.recognition.spotting import Spotter
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.store import ClipStore, DemonstrationSource, JobStatus, LanguageState, SourceStore

CACHED_TAKES = 64
"""Number of clips whose takes are cached: spotting takes a fifth of a clip's duration, and trimming
some milliseconds a take."""


SAME_TAKE = 0.5
"""Share of a take that a demonstration, or a labelled take, must cover to count as the same."""

CACHED_CLIPS = 512
"""Number of clips whose outlines and faults are cached: the demonstrations of several large
languages."""

LeftOut = tuple[tuple[str, int], ...]
"""Label and number of demonstrations that the language is read without."""


Told = TypeVar("Told")


class Demonstrations:
    """The demonstrations of languages, with the clips that they come from where these are known.

    Parameters
    ----------
    clips, sources
        The store.

    Attributes
    ----------
    clips
        The store of the clips.

    """

    def __init__(self, clips: ClipStore, sources: SourceStore) -> None:
        self.clips, self._sources = clips, sources

    def keep(
        self,
        state: LanguageState,
        label: str,
        where: NewDemonstration,
        demonstration: ClipRange,
        *,
        index: int = 0,
    ) -> None:
        """Store the source of a gesture's demonstration that was just saved."""
        language = language_of(state)
        key = _key(language.gesture(label).single_demonstrations()[index])
        if key is None:
            return
        start = demonstration.start if where.start is None else where.start
        end = demonstration.end if where.end is None else where.end
        if where.start is None and where.end is None:
            # A request without a range means the clip's only take, from salute to salute.
            for take in find_brackets(recording_of(self.clips, where.clip_id), language.trigger):
                start, end = take.start, take.end
        source = DemonstrationSource(
            trajectory=key,
            clip_id=where.clip_id,
            start=start,
            end=end,
            keep_transit=where.keep_transit,
        )
        self._sources.keep(source)

    def find(self, language: Language) -> dict[str, list[DemonstrationSource | None]]:
        """Return the source of every demonstration of a language by label; None if not known."""
        return self.find_by_digests(digests_of(language))

    def find_by_digests(
        self, digests: dict[str, list[str | None]]
    ) -> dict[str, list[DemonstrationSource | None]]:
        """Return the same by what `digests_of` returns of the language."""
        known = self._sources.of({key for row in digests.values() for key in row if key})
        return {
            label: [None if key is None else known.get(key) for key in row]
            for label, row in digests.items()
        }

    def clips_of(self, language: Language) -> set[str]:
        """Return the ids of the clips that a language's demonstrations come from."""
        rows = self.find(language).values()
        return {source.clip_id for row in rows for source in row if source is not None}

    def view(self, language: Language) -> dict[str, list[SourceView | None]]:
        """Return the known sources of demonstrations by label, as the API shows them."""
        trigger = language.trigger

        def view(source: DemonstrationSource, shown: Gesture) -> SourceView:
            faults = view_faults(self.clips, source, shown, trigger)
            where = source.clip_id, source.start, source.end
            return SourceView(
                **source.model_dump(exclude={"trajectory"}),
                salutes=count_triggers_in_clip(self.clips, *where, trigger),
                fault=faults[0].words if faults else None,
                faults=faults,
            )

        return self._tell(language, view, None)

    def find_faults(self, language: Language) -> dict[str, list[tuple[DemonstrationFault, ...]]]:
        """Return by label the faults of each demonstration; none where its clip is not known."""

        def find(source: DemonstrationSource, shown: Gesture) -> tuple[DemonstrationFault, ...]:
            return faults_of_source(self.clips, source, shown, language.trigger)

        return self._tell(language, find, ())

    def _tell(
        self,
        language: Language,
        tell: Callable[[DemonstrationSource, Gesture], Told],
        unknown: Told,
    ) -> dict[str, list[Told]]:
        """Return by label what is told of each source and its demonstration."""
        return {
            label: [
                unknown if source is None else tell(source, shown)
                for source, shown in zip(
                    row, language.gesture(label).single_demonstrations(), strict=True
                )
            ]
            for label, row in self.find(language).items()
        }


def digests_of(language: Language) -> dict[str, list[str | None]]:
    """Return a digest of each demonstration of a language by label; None without a trajectory."""
    return {
        gesture.label: [_key(each) for each in gesture.single_demonstrations()]
        for gesture in language.gestures
    }


class OwnDemonstrations:
    """The demonstrations of a language that are known takes as well.

    Parameters
    ----------
    demonstrations
        Knows their sources.
    language
        The language, with the change of the trial.
    trial
        A change that is not saved: the source of its demonstration is not stored.

    """

    def __init__(
        self, demonstrations: Demonstrations, language: Language, trial: GestureTrial | None = None
    ) -> None:
        self._language = language
        self._shown = digests_of(language)
        self._of_clip = defaultdict[str, list[tuple[str, int, float, float]]](list)
        for label, row in demonstrations.find_by_digests(self._shown).items():
            for number, source in enumerate(row):
                if source is not None:
                    place = (label, number, source.start, source.end)
                    self._of_clip[source.clip_id].append(place)
        if trial is not None and (tried := trial.change.demonstration) is not None:
            label = language.gesture(trial.label).label
            number = len(self._shown[label]) - 1 if trial.change.further else 0
            end = math.inf if tried.end is None else tried.end
            place = (label, number, tried.start or 0.0, end)
            self._of_clip[tried.clip_id].append(place)

    def find(self, clip_id: str, start: float, end: float) -> LeftOut:
        """Return label and number of each demonstration that covers most of a take."""
        least = SAME_TAKE * (end - start)
        found = (
            (label, number)
            for label, number, begun, ended in self._of_clip.get(clip_id, ())
            if min(end, ended) - max(start, begun) > least
        )
        return tuple(dict.fromkeys(found))

    def show_former(self, expected: str, former: Sequence[str] | None) -> bool:
        """Return whether a gesture has another movement than one of these digests."""
        return former is not None and {*former}.isdisjoint(self._shown.get(expected, ()))

    def leave_one(self, expected: str, without: LeftOut) -> bool:
        """Return whether a gesture is known by another demonstration than those left out.

        A take of none of the gestures, `NONE_EXPECTED`, needs no demonstration.
        """
        if expected == NONE_EXPECTED:
            return True
        if expected not in self._language.labels:
            return False
        own = sum(label == expected for label, _ in without)
        return own <= len(self._language.gesture(expected).further)


def view_faults(
    clips: ClipStore,
    source: DemonstrationSource | NewDemonstration,
    shown: Gesture,
    trigger: Trigger,
) -> list[DemonstrationFaultView]:
    """Return the faults of a demonstration as the API shows them; see `faults_of_source`."""
    return [
        DemonstrationFaultView(**vars(fault), sentence=fault.describe(shown.label))
        for fault in faults_of_source(clips, source, shown, trigger)
    ]


def _key(gesture: Gesture) -> str | None:
    """Return a digest of the demonstration's trajectory; None without one."""
    trajectory = gesture.trajectory
    if trajectory is None:
        return None
    digest = hashlib.sha256(json.dumps([trajectory.landmarks, trajectory.unit]).encode())
    for values in (trajectory.time, trajectory.xy):
        digest.update(values.astype("<f8").tobytes())
    return digest.hexdigest()


def count_triggers_in_clip(
    clips: ClipStore, clip_id: str, start: float, end: float, trigger: Trigger
) -> int:
    """Return how many triggers a range of a clip contains; 0 while its poses are not extracted."""
    file = _find_recording(clips, clip_id)
    return 0 if file is None else _outline_of(file, trigger).count_triggers(start, end)


def faults_of_source(
    clips: ClipStore,
    source: DemonstrationSource | NewDemonstration,
    gesture: Gesture,
    trigger: Trigger,
) -> tuple[DemonstrationFault, ...]:
    """Return the faults of a demonstration whose clip is known, the gravest first.

    Parameters
    ----------
    clips
        The store of the clips.
    source
        Where the demonstration comes from.
    gesture
        The gesture with this demonstration alone.
    trigger
        The language's.

    """
    file = _find_recording(clips, source.clip_id)
    if file is None:
        return ()
    counts = gesture.switches.hand_shape == "on"
    where = (source.start, source.end, source.keep_transit)
    return _faults_of(file, where, trigger, gesture.salient, counts)


def _find_recording(clips: ClipStore, clip_id: str) -> RecordingFile | None:
    """Return the file of a clip's recording; None while its poses are not extracted."""
    if clips.get(clip_id).job.status != JobStatus.DONE:
        return None
    return whole_recording(clips.recording(clip_id))


@lru_cache(CACHED_CLIPS)
def _outline_of(file: RecordingFile, trigger: Trigger) -> ClipOutline:
    return ClipOutline.of(load_recording(file), trigger)


@lru_cache(CACHED_CLIPS)
def _faults_of(
    file: RecordingFile,
    where: tuple[float | None, float | None, bool],
    trigger: Trigger,
    salient: Sequence[str],
    counts: bool,
) -> tuple[DemonstrationFault, ...]:
    start, end, keep_transit = where
    try:
        return find_demonstration_faults(
            load_recording(file),
            start,
            end,
            outline=_outline_of(file, trigger),
            trigger=trigger,
            keep_transit=keep_transit,
            salient=salient,
            hand_counts=counts,
        )
    except OsgError:
        return ()


def find_takes(
    clips: ClipStore, clip_id: str, state: LanguageState | None, *, so_far: bool = False
) -> tuple[TakeView, ...]:
    """Return the takes of a clip by a language's trigger; without a trigger, the spotted gestures.

    With `so_far`, those that have ended in a clip whose other frames are being read.

    Raises
    ------
    NotFound, ProblemError
        As `recording_file`.

    """
    recording = recording_file(clips, clip_id, so_far=so_far)
    trigger = SALUTE if state is None else language_of(state).trigger
    if state is not None and trigger.spots:
        takes = _spot(recording, state.revision.document)
    else:
        takes = _segment(recording, trigger)
    return takes if recording.whole else tuple(take for take in takes if take.closed)


@lru_cache(CACHED_TAKES)
def _segment(recording: RecordingFile, trigger: Trigger) -> tuple[TakeView, ...]:
    """Find the takes between held triggers."""
    return tuple(
        TakeView.model_validate(take)
        for take in takes_in(load_recording(recording), trigger=trigger)
    )


@lru_cache(CACHED_TAKES)
def _spot(recording: RecordingFile, document: str) -> tuple[TakeView, ...]:
    """Spot a language's gestures; return none if none of them can be spotted."""
    try:
        spotter = Spotter(Recognizer(Language.from_json(document)))
    except OsgError:
        return ()
    return tuple(
        TakeView(
            start=found.start,
            end=found.end,
            closed=True,
            stroke_start=found.start,
            stroke_end=found.end,
        )
        for found in spotter.listen(load_recording(recording).poses)
    )
