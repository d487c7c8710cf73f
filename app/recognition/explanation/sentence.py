"""The sentence that says why, made of what an explanation has measured."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from app.recognition.explanation.differences import Difference
from app.recognition.text.wording import humanize_all, join_words

if TYPE_CHECKING:
    from app.recognition.explanation.explanation import Explanation

NUMBERS = (
    "none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve",
)  # fmt: skip
"""Spelt out in sentences, as far as is usual."""

MOST_VOTERS_NAMED = 3
"""Voters named in a sentence; the table has all."""


def write_sentence(explanation: Explanation) -> str:
    """Say why a recognition came out as it did, in one to three sentences."""
    if explanation.right:
        return _right(explanation)
    parts = [_outcome(explanation) + _reason(explanation)]
    beside = [each.words for each in explanation.differences if each.share == 0]
    if beside:
        parts.append(f"Besides, {join_words(beside)}.")
    parts.append(_remedy(explanation))
    return " ".join(part for part in parts if part)


def _right(explanation: Explanation) -> str:
    took = _voters(explanation, explanation.expected)
    start = f"{took} took {explanation.expected!r}, as expected"
    if explanation.other is None or not math.isfinite(explanation.other_score):
        return f"{start}; no other gesture could be compared."
    return (
        f"{start}; the runner-up is {explanation.other!r}, {_farther(explanation)} "
        f"(confidence {explanation.confidence:.2f})."
    )


def _farther(explanation: Explanation) -> str:
    score, other = explanation.score, explanation.other_score
    return f"at a distance of {other:.2f} against {score:.2f}"


def _outcome(explanation: Explanation) -> str:
    if explanation.fault is not None:
        return f"Nothing was recognised, for the recording is too poor: {explanation.fault}"
    if explanation.label is not None:
        wrong = _voters(explanation, explanation.nearest)
        return f"{wrong} took {explanation.nearest!r} instead of {explanation.expected!r}"
    if explanation.nearest != explanation.expected:
        return f"Nothing was recognised; {explanation.nearest!r} was nearest"
    return (
        f"Nothing was recognised: {explanation.expected!r} was nearest, but lies "
        f"{explanation.novelty:.1f} times as far as its thresholds allow"
    )


def _voters(explanation: Explanation, label: str) -> str:
    count, total = explanation.votes.get(label, 0), sum(explanation.votes.values())
    return f"{_number(count)} of {_number(total)} voters".capitalize()


def _number(count: int) -> str:
    return NUMBERS[count] if count < len(NUMBERS) else str(count)


def _reason(explanation: Explanation) -> str:
    if explanation.fault is not None:
        return "."
    if not math.isfinite(explanation.score):
        return f": a keypoint that {explanation.expected!r} needs is missing or does not move."
    cause = _cause(explanation)
    spoke = _testimony(explanation)
    if cause is not None:
        return f" because {cause.words}" + (f" ({spoke})." if spoke else ".")
    return f"; {spoke}." if spoke else "."


def _testimony(explanation: Explanation) -> str:
    """Name the voters that spoke most against the expected gesture, if any did."""
    loudest = humanize_all(_witnesses(explanation)[:MOST_VOTERS_NAMED])
    return f"{join_words(loudest)} spoke most against {explanation.expected!r}" if loudest else ""


def _witnesses(explanation: Explanation) -> list[str]:
    """Name the voters that spoke against the expected gesture, the loudest first.

    Where it was nearest and rejected all the same, those that are farthest beyond their limits.
    """
    if explanation.nearest != explanation.expected:
        return [verdict.voter for verdict in explanation.verdicts if verdict.against > 0]
    beyond = {
        verdict.voter: verdict.distance / verdict.limit
        for verdict in explanation.verdicts
        if verdict.limit and verdict.distance > verdict.limit
    }
    return sorted(beyond, key=lambda voter: -beyond[voter])


def _cause(explanation: Explanation) -> Difference | None:
    """Return the difference that explains most, if any does."""
    loudest = explanation.verdicts[0].voter if explanation.verdicts else ""
    kinds = {"tempo": "tempo", "posture": "place"}
    told = [each for each in explanation.differences if each.kind == kinds.get(loudest)]
    told += [each for each in explanation.differences if each.share > 0]
    return told[0] if told else None


def _remedy(explanation: Explanation) -> str:
    found = explanation.counterfactuals.found
    if found:
        return f"It would have been read as {explanation.expected!r} {found[0].change.words}."
    tried = explanation.counterfactuals.tried
    return f"None of {tried} changes tried would have turned it right." if tried else ""
