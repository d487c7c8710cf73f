"""Test sets: their takes, the results of these, and the rates."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from pydantic import Field

from app import __version__, store
from app.api.http.problems import ProblemError, problem_of
from app.api.http.schemas.values import (
    NONE_EXPECTED,
    Body,
    ExpectedGestureView,
    Identifier,
    RequiredGesture,
    Seconds,
    View,
)
from app.api.jobs.job import Job, Report, events_about, run_task
from app.api.services.clip_responses import shows_pictures
from app.api.services.demonstration_sources import LeftOut, OwnDemonstrations, find_takes
from app.api.services.recording_cache import recording_file, recording_of
from app.api.services.running_studio import Studio
from app.api.services.stored_languages import language_of
from app.api.services.stored_recognitions import WITHOUT
from app.api.workers.tasks import TakeToRecognize, TestRun
from app.api.workers.worker_messages import Failed, Finished, Progress, RecognizedTake
from app.evaluation.share import Share
from app.recognition.decision.result import Pair
from app.recognition.health.finding import TestedGesture
from app.recognition.recording.clip_range import find_clip_range
from app.store.takes import MOST_TAKES


class LabelledTakeDraft(RequiredGesture):
    """A clip, or a range of it, with the gesture that it shows."""

    clip_id: Identifier
    start: Seconds | None = None
    """Null, with `end`: every take of the clip, or all of it."""
    end: Seconds | None = None


class LabelledTakesDraft(Body):
    """Takes to add to a test set; one that it has gets the new label."""

    takes: Annotated[list[LabelledTakeDraft], Field(min_length=1, max_length=MOST_TAKES)]


class LabelledTakeChange(RequiredGesture):
    """Another label for a take."""


class LabelledResultView(View):
    """How a revision recognises a labelled take."""

    revision: int
    recognition_id: str | None
    """Null: it could not be recognised, see `fault`."""
    label: str | None
    """Null: a pair, or rejected."""
    pair: Pair
    nearest: str | None
    confidence: float
    right: bool
    fault: str | None
    """Why it could not be recognised, in words."""


class LabelledTakeView(ExpectedGestureView):
    """A take of a test set."""

    id: str
    clip_id: str
    clip: str
    """Name of the clip."""
    start: float
    end: float
    added_by: str
    """Name of who added it; empty: not known."""
    demonstration: bool
    """It is a demonstration of the language, which reads it without that demonstration."""
    testable: bool
    """Whether the language has another demonstration of its gesture; null results otherwise."""
    set_aside: bool
    """It shows the movement that its gesture had before, and counts for nothing; `PATCH` with its
    label brings it back."""
    result: LabelledResultView | None
    """The newest; null: none yet."""
    before: LabelledResultView | None
    """By an older revision than `result`."""


class RateView(View):
    """Rate of right answers, with Wilson's 95 % interval; null without any answer."""

    right: int
    asked: int
    """Takes, those of pairs included."""
    pairs: int
    """Takes that lie between two gestures: neither right nor a wrong label."""
    pairs_right: int
    """Of these, those with the right gesture in the pair."""
    untestable: int
    """Takes beside these: the language has no other demonstration of their gesture."""
    rate: float | None
    low: float | None
    high: float | None


class NoneRateView(View):
    """Answers to takes that show none of the gestures."""

    refused: int
    """Right."""
    asked_back: int
    answered: int
    """Wrong."""


class GestureRateView(RateView):
    """Rate of one gesture."""

    label: str


class TestSetView(View):
    """The test set of a language, with the newest result of each take."""

    __test__ = False

    language_id: str
    revision: int
    """The language's newest."""
    takes: list[LabelledTakeView]
    overall: RateView
    """A refusal is right of a take that shows none of the gestures."""
    gestures: list[GestureRateView]
    """The lowest rate first."""
    none: NoneRateView
    better: list[str]
    """Ids of takes that are answered better than before."""
    worse: list[str]
    """Ids of takes that are answered worse than before: right is better than a pair with the right
    gesture, which is better than anything else."""
    upgraded: bool
    """Whether the results before are of another version of the program, which may answer otherwise
    too."""
    waiting: int
    """Testable takes without a result of the newest revision."""


def add_labelled(
    studio: Studio, state: store.LanguageState, drafts: Sequence[LabelledTakeDraft], sender: str
) -> None:
    """Add takes to the test set of a language in the name of a sender.

    Raises
    ------
    NotFound
        When there is no such clip.
    ProblemError
        409 while a clip's poses are not extracted, 422 for an empty range.
    TestSetFull
        When the set would have more takes than it may.

    """
    language = language_of(state)
    takes = [
        store.LabelledTake(
            language_id=state.record.id,
            clip_id=draft.clip_id,
            start=start,
            end=end,
            expected=language.spell(draft.stored),
            added_by=sender,
        )
        for draft in drafts
        for start, end in _ranges(studio.clips, draft, state)
    ]
    studio.takes.add(takes)


def test_run_key(language_id: str, revision: int) -> str:
    """Return the identity of the run of a revision among the jobs: two would do the same."""
    return f"test {language_id} {revision}"


def test_run_of(studio: Studio, state: store.LanguageState) -> Job[Finished | Failed] | None:
    """Return the job that recognises the takes without a result for the revision; None if none is.

    For a clip without poses, this fault is stored as the result of its takes.

    Raises
    ------
    StoreUnavailable
        When the files of a clip are temporarily not available.

    """
    takes, wanted = [], []
    for take, without, view in _view_takes(studio, state):
        if not _is_waiting(view, state.revision.revision):
            continue
        try:
            wanted.append(_request_for(studio.clips, take, without))
            takes.append(take)
        except (ProblemError, store.NotFound) as error:
            fault = problem_of(error).detail
            answer = RecognizedTake(start=take.start, end=take.end, fault=fault)
            _keep(studio, state, take, without, answer)
    if not takes:
        return None
    language_id, revision = state.record.id, state.revision.revision

    def keep(index: int, found: RecognizedTake) -> None:
        if index < len(takes):  # A process that a file has taken over may say anything.
            _keep(studio, state, takes[index], wanted[index].without, found)

    async def run(report: Report) -> Finished | Failed:
        # It may have to wait for its turn.
        report(Progress(stage="recognising", total=len(takes)))
        task = TestRun(document=state.revision.document, takes=tuple(wanted))
        return await run_task(studio.workers, task, report, keep)

    event = events_about("tests", id=language_id, revision=revision)
    return Job("test_run", test_run_key(language_id, revision), event, run, detached=True)


def _is_waiting(take: LabelledTakeView, revision: int) -> bool:
    return take.testable and (take.result is None or take.result.revision != revision)


def view_test_set(studio: Studio, state: store.LanguageState) -> TestSetView:
    """Return the test set of a language, as of its newest revision."""
    takes = [view for _, _, view in _view_takes(studio, state)]
    counting = [take for take in takes if not take.set_aside]
    counted = [(take, take.result) for take in takes if take.testable and take.result is not None]
    compared = [(take, result, take.before) for take, result in counted if take.before is not None]
    gains = {take.id: _worth(take, now) - _worth(take, before) for take, now, before in compared}
    return TestSetView(
        language_id=state.record.id,
        revision=state.revision.revision,
        takes=takes,
        overall=RateView(**_rate(counting)),
        gestures=_rate_gestures(counting),
        none=_rate_none([result for take, result in counted if take.expected_none]),
        better=[each for each, gain in gains.items() if gain > 0],
        worse=[each for each, gain in gains.items() if gain < 0],
        upgraded=_were_upgraded(studio.recognitions, compared),
        waiting=sum(_is_waiting(take, state.revision.revision) for take in takes),
    )


def list_tested(studio: Studio, state: store.LanguageState) -> list[TestedGesture]:
    """Return what the test set has shown of each gesture of a language."""
    found = view_test_set(studio, state).gestures
    return [TestedGesture(each.label, each.right, each.asked) for each in found]


def _request_for(
    clips: store.ClipStore, take: store.LabelledTake, without: LeftOut
) -> TakeToRecognize:
    clip = clips.get(take.clip_id).clip
    return TakeToRecognize(
        recording=recording_file(clips, take.clip_id).path,
        start=take.start,
        end=take.end,
        keypoints_of=None if shows_pictures(clip) else clip.name,
        without=without,
    )


def _keep(
    studio: Studio,
    state: store.LanguageState,
    take: store.LabelledTake,
    without: LeftOut,
    found: RecognizedTake,
) -> None:
    """Store the result of a take, also if it cannot be recognised."""
    result = store.LabelledResult(
        take_id=take.id, revision=state.revision.revision, fault=found.fault
    )
    if (answer := found.answer) is not None:
        record = store.RecognitionRecord(
            clip_id=take.clip_id,
            language_id=state.record.id,
            revision=state.revision.revision,
            start=found.start,
            end=found.end,
            profile=language_of(state).profile,
            expected=take.expected,
            result=json.dumps(answer | {"version": __version__, WITHOUT: without}, allow_nan=False),
        )
        result.recognition_id = studio.recognitions.add(record).id
        result.label, result.nearest = answer["label"], answer["nearest"]
        result.pair = answer["pair"]
        result.confidence = answer["confidence"]
    studio.takes.keep(result, take.expected)


def _ranges(
    clips: store.ClipStore, draft: LabelledTakeDraft, state: store.LanguageState
) -> Iterator[tuple[float, float]]:
    """Yield start and end of each take that a draft means."""
    recording = recording_of(clips, draft.clip_id)
    if draft.start is None and draft.end is None:
        takes = find_takes(clips, draft.clip_id, state)
        yield from ((take.start, take.end) for take in takes)
        if not takes:
            yield float(recording.poses.time[0]), float(recording.poses.time[-1])
        return
    trigger = language_of(state).trigger
    meant = find_clip_range(recording, draft.start, draft.end, trigger=trigger)
    yield (
        meant.start if draft.start is None else draft.start,
        meant.end if draft.end is None else draft.end,
    )


def _worth(take: LabelledTakeView, result: LabelledResultView) -> int:
    """Return 2 for a right answer, 1 for a pair with the right gesture, 0 for any other answer.

    Where no gesture is right, any pair is better than a label.
    """
    asked_back = result.pair is not None and (take.expected_none or take.expected in result.pair)
    return 2 * result.right or int(asked_back)


def _were_upgraded(
    recognitions: store.RecognitionStore,
    compared: Sequence[tuple[LabelledTakeView, LabelledResultView, LabelledResultView]],
) -> bool:
    """Return whether another version of the program gave the oldest results before."""
    pairs = [pair for _, *pair in compared if all(each.recognition_id for each in pair)]
    if not pairs:
        return False
    try:
        versions = {
            json.loads(recognitions.get(each.recognition_id or "").result).get("version")
            for each in min(pairs, key=lambda pair: pair[1].revision)
        }
    except store.NotFound:
        return False
    return len(versions) > 1  # Versions up to 0.2.0 stored none.


def _rate(takes: Sequence[LabelledTakeView]) -> dict[str, Any]:
    counted = [(take, take.result) for take in takes if take.testable and take.result is not None]
    share = Share(sum(result.right for _, result in counted), len(counted))
    low, high = share.interval() or (None, None)
    return {
        "right": share.correct,
        "asked": share.asked,
        "pairs": sum(result.pair is not None for _, result in counted),
        "pairs_right": sum(take.expected in (result.pair or ()) for take, result in counted),
        "untestable": sum(not take.testable for take in takes),
        "rate": share.value,
        "low": low,
        "high": high,
    }


def _rate_gestures(takes: Sequence[LabelledTakeView]) -> list[GestureRateView]:
    """Return the rates of all gestures that takes show, the worst first."""
    shown: dict[str, list[LabelledTakeView]] = {}
    for take in takes:
        if take.expected is not None:
            shown.setdefault(take.expected, []).append(take)
    rates = [
        GestureRateView(label=label, **_rate(own))
        for label, own in shown.items()
        if any(take.result is not None or not take.testable for take in own)
    ]
    return sorted(rates, key=lambda each: each.rate or 0.0)


def _rate_none(results: Sequence[LabelledResultView]) -> NoneRateView:
    """Return what became of takes that show none of the gestures."""
    return NoneRateView(
        refused=sum(result.right for result in results),
        asked_back=sum(result.pair is not None for result in results),
        answered=sum(result.label is not None for result in results),
    )


def _list_valid(
    recognitions: store.RecognitionStore, tested: store.TestedTake, without: LeftOut
) -> list[store.LabelledResult]:
    """Return the results of a testable take that its own demonstration has not read.

    Versions before 0.4 read a demonstration by itself.
    """
    if not without:
        return [*tested.results]
    return [each for each in tested.results if _is_apart(recognitions, each.recognition_id)]


def _is_apart(recognitions: store.RecognitionStore, recognition: str | None) -> bool:
    try:
        record = None if recognition is None else recognitions.get(recognition)
    except store.NotFound:
        return False
    return record is None or WITHOUT in json.loads(record.result)


def _is_right(take: store.LabelledTake, result: store.LabelledResult) -> bool:
    if take.expected == NONE_EXPECTED:
        return result.label is None and result.pair is None and result.fault is None
    return result.label == take.expected


def _view_takes(
    studio: Studio, state: store.LanguageState
) -> Iterator[tuple[store.LabelledTake, LeftOut, LabelledTakeView]]:
    """Yield each take of a language, the demonstrations that it is itself, and what is shown."""
    own = OwnDemonstrations(studio.demonstrations, language_of(state))
    for tested in studio.takes.tested(state.record.id):
        take = tested.take
        without = own.find(take.clip_id, take.start, take.end)
        yield take, without, _view(studio.recognitions, tested, own, without)


def _view(
    recognitions: store.RecognitionStore,
    tested: store.TestedTake,
    own: OwnDemonstrations,
    without: LeftOut,
) -> LabelledTakeView:
    take = tested.take
    set_aside = own.show_former(take.expected, take.former)
    is_testable = own.leave_one(take.expected, without) and not set_aside
    results = [
        LabelledResultView(
            **result.model_dump(exclude={"take_id", "created"}),
            right=_is_right(take, result),
        )
        for result in (_list_valid(recognitions, tested, without) if is_testable else ())
    ]
    return LabelledTakeView(
        **take.model_dump(exclude={"language_id", "created", "former"}),
        clip=tested.clip,
        demonstration=bool(without),
        testable=is_testable,
        set_aside=set_aside,
        result=results[0] if results else None,
        before=results[1] if len(results) > 1 else None,
    )
