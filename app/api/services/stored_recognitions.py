"""Stored recognitions and known takes, as result, as context of an explanation, or as response."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import Any

from app import store
from app.api.http.problems import ProblemError
from app.api.http.schemas.gestures import GestureTrial, RecognitionRequest, RecognitionView
from app.api.services.clip_responses import shows_pictures
from app.api.services.demonstration_sources import (
    Demonstrations,
    LeftOut,
    OwnDemonstrations,
    count_triggers_in_clip,
    find_takes,
)
from app.api.services.gesture_edits import change_gesture_of, demonstration_at
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import Studio
from app.api.services.stored_languages import language_of, recognizer_of
from app.recognition import Language, OsgError, PoseSequence, Recognition, Recognizer
from app.recognition.explanation.context import KnownTake, RecognitionContext
from app.recognition.explanation.counterfactuals import Counterfactual, Intervention
from app.recognition.explanation.demonstration_faults import describe_count
from app.recognition.language.file_schema import TuningEntry, entry_to_tuning
from app.recognition.language.requirements import require_seen_landmarks
from app.recognition.recording.clip_range import find_clip_range, find_surroundings
from app.store import RecognitionRecord

MOST_KNOWN_TAKES = 60
"""Most known takes by which remedies are judged, the newest first; each is recognised again with
every remedy."""

MOST_APART = 12
"""Most languages without a demonstration that read known takes; each is made for every remedy."""


WITHOUT = "without"
"""Key of a stored result: the demonstrations that did not read the take."""


def recognize_range(
    studio: Studio, wanted: RecognitionRequest, quota: store.Quota
) -> store.RecognitionRecord:
    """Recognise a range of a clip by the newest revision of a language, and store the answer.

    A demonstration, also one on trial, is read by the others of its gesture, if there are any.

    Raises
    ------
    NotFound, ProblemError, OsgError
        As `recording_file`, `find_clip_range`, `require_landmarks_of` and `try_gesture`.
    QuotaExceeded
        When the sender may not keep another recognition.

    """
    state = studio.languages.get(wanted.language_id)
    language = language_of(state)
    recording = recording_of(studio.clips, wanted.clip_id, so_far=wanted.end is not None)
    if wanted.end is not None and wanted.end > recording.poses.time[-1]:
        # Refused while these frames are being read.
        recording = recording_of(studio.clips, wanted.clip_id)
    profile = wanted.profile or language.profile
    require_landmarks_of(studio.clips.get(wanted.clip_id).clip, recording.poses, language)
    meant = find_clip_range(recording, wanted.start, wanted.end, trigger=language.trigger)
    changed = try_gesture(studio.clips, language, wanted.trial)
    own = OwnDemonstrations(studio.demonstrations, changed or language, wanted.trial)
    without = own.find(wanted.clip_id, meant.start, meant.end)
    if not all(own.leave_one(label, without) for label, _ in without):
        without = ()
    recognizer = make_recognizer(state, profile, wanted.tuning, changed, without)
    answer = recognizer.recognize(meant.poses, meant.unseen).to_dict()
    if without:
        answer[WITHOUT] = without
    if wanted.tuning is not None:
        answer["tuning"] = wanted.tuning.model_dump()
    if wanted.trial is not None:
        answer["trial"] = wanted.trial.model_dump(exclude_unset=True)
    record = store.RecognitionRecord(
        clip_id=wanted.clip_id,
        language_id=state.record.id,
        revision=state.revision.revision,
        start=meant.start,
        end=meant.end,
        profile=profile,
        expected=None if wanted.stored is None else language.spell(wanted.stored),
        result=json.dumps(answer, allow_nan=False),
    )
    return studio.keep_within(quota, lambda: studio.recognitions.add(record, quota))


def require_landmarks_of(clip: store.Clip, poses: PoseSequence, language: Language) -> None:
    """Refuse a clip of keypoints that lacks some that the language needs.

    Pictures may show any landmark, so their clips are only judged when they are recognised.

    Raises
    ------
    LandmarkError
        When one is missing; the message names the landmark and the gesture that needs it.

    """
    if not shows_pictures(clip):
        require_seen_landmarks(language, poses, clip.name)


def load_context(record: store.RecognitionRecord, studio: Studio) -> RecognitionContext:
    """Return the context in which a recognition was made, by the language as it was then."""
    state = studio.languages.get(record.language_id, record.revision)
    recording = recording_of(studio.clips, record.clip_id, so_far=True)
    view = view_recognition(record)
    recognizer = make_recognizer(
        state,
        record.profile,
        view.tuning,
        try_gesture(studio.clips, language_of(state), view.trial),
        [(str(label), int(number)) for label, number in view.without],
    )
    language = recognizer.language
    return RecognitionContext(
        recognizer=recognizer,
        poses=find_clip_range(recording, record.start, record.end, trigger=language.trigger).poses,
        whole=find_surroundings(recording, record.start, record.end, language.trigger),
        known=tuple(load_known(studio, record.language_id, recognizer, but=record.clip_id)),
        faults=studio.demonstrations.find_faults(language),
        closed=not any(
            not take.closed and min(take.end, record.end) > max(take.start, record.start)
            for take in find_takes(studio.clips, record.clip_id, state, so_far=True)
        ),
        recorded=load_recognition(record),
    )


def locate_cuts(
    demonstrations: Demonstrations,
    language: Language,
    counterfactuals: Iterable[Counterfactual],
) -> Iterator[Counterfactual]:
    """Yield the counterfactuals, of every cut demonstration with its clip and the range of it.

    A cut is left out where the clip of the demonstration is not known, or where it is not the
    gesture's first one, which alone can be replaced.
    """
    sources = demonstrations.find(language)
    for found in counterfactuals:
        change = found.change
        if change.kind != "demonstration_cut":
            yield found
            continue
        values = change.values
        source = sources[values["label"]][0] if values["demonstration"] == 0 else None
        if source is None:
            continue
        begin = demonstration_at(demonstrations.clips, source, language.trigger).start
        located = {
            "clip_id": source.clip_id,
            "clip_start": begin + values["start"],
            "clip_end": begin + values["end"],
        }
        cut = Intervention(change.kind, change.size, {**values, **located})
        yield replace(found, change=cut)


def make_recognizer(
    state: store.LanguageState,
    profile: str,
    tuning: TuningEntry | None,
    changed: Language | None,
    without: Collection[tuple[str, int]] = (),
) -> Recognizer:
    """Return a recogniser of a revision, with a tuning and a `changed` language (`try_gesture`).

    The revision is not edited: the recogniser's language is a copy, which lacks the demonstrations
    `without`.
    """
    if tuning is None and changed is None and not without:
        return recognizer_of(state, profile)
    language = language_of(state) if changed is None else changed
    tuned = None if tuning is None else entry_to_tuning(tuning)
    return Recognizer(language.without_demonstrations(without), profile, tuning=tuned)


def try_gesture(
    clips: store.ClipStore, language: Language, trial: GestureTrial | None
) -> Language | None:
    """Return a copy of a language in which one gesture is changed; None without a trial.

    Raises
    ------
    ProblemError
        404 when the language has no gesture of the trial's label, 422 when the change is not
        possible.

    """
    if trial is None:
        return None
    # The answer names gestures as the language does: a new label is not tried.
    change = trial.change.model_copy(update={"label": None})
    shown = change.demonstration
    demonstration = None if shown is None else demonstration_at(clips, shown, language.trigger)
    return change_gesture_of(language, trial.label, change, demonstration)


def load_recognition(record: store.RecognitionRecord) -> Recognition:
    """Return the recogniser's answer as it was when `record` was made."""
    result: dict[str, Any] = json.loads(record.result)
    return Recognition.from_dict(result)


def view_recognition(record: store.RecognitionRecord) -> RecognitionView:
    """Return a stored recognition as the API shows it."""
    return RecognitionView(**(json.loads(record.result) | record.model_dump(exclude={"result"})))


def write_notes(
    demonstrations: Demonstrations,
    record: RecognitionRecord,
    language: Language,
    nearest: str | None = None,
) -> list[str]:
    """Return a sentence for the range, and for each demonstration of a gesture with a fault.

    Parameters
    ----------
    demonstrations
        The demonstrations of languages, with the clips.
    record
        The recognition.
    language
        The revision used.
    nearest
        Label of the gesture whose demonstrations matter; None: none do.

    """
    notes = []
    trigger, where = language.trigger, (record.clip_id, record.start, record.end)
    if count := count_triggers_in_clip(demonstrations.clips, *where, trigger):
        between = "salutes" if trigger.start is None else "poses"
        contained = describe_count(trigger, count)
        notes.append(
            f"The range that was recognised contains {contained}; choose a take, or a range "
            f"between the {between}."
        )
    if nearest is not None:
        for source in demonstrations.view(language).get(nearest, []):
            if source is not None and source.faults:
                notes.append(source.faults[0].sentence)
    return notes


def load_known(
    studio: Studio, language_id: str, recognizer: Recognizer, *, but: str | None = None
) -> Iterator[KnownTake]:
    """Yield the known takes of a language, the newest first.

    One that is a demonstration is read without it; where its gesture has no other one, it is left
    out.

    Parameters
    ----------
    studio
        Running studio with the takes.
    language_id
        The language's.
    recognizer
        Of a revision of it.
    but
        A clip whose takes are left out.

    """
    language = recognizer.language
    own = OwnDemonstrations(studio.demonstrations, language)
    count, apart = 0, set[LeftOut]()
    for take in reversed(studio.takes.known(language_id)):
        if take.clip_id == but or take.expected not in language.labels:
            continue
        if own.show_former(take.expected, take.former):
            continue
        if count == MOST_KNOWN_TAKES:
            return
        try:
            recording = recording_of(studio.clips, take.clip_id)
            found = find_clip_range(recording, take.start, take.end, trigger=language.trigger)
            without = own.find(take.clip_id, found.start, found.end)
            is_new = without and without not in apart
            if not own.leave_one(take.expected, without) or (is_new and len(apart) == MOST_APART):
                continue
            if is_new:
                apart.add(without)
            yield KnownTake(take.expected, recognizer.query(found.poses), without)
        except (OsgError, ProblemError, store.NotFound):
            continue
        count += 1
