"""Explanation sentence: an explanation in one to three sentences."""

from __future__ import annotations

import math

from app.recognition.explanation.analysis import Analysis
from app.recognition.explanation.differences import Difference
from app.recognition.text.wording import humanize_all, join_words
from app.recognition.voters.registry import HAND_VOTER_NAMES

MOST_VOTERS_NAMED = 3
"""Voters named in a sentence; the table has all."""


def write_sentence(analysis: Analysis) -> str:
    """Explain a recognition in one to three sentences."""
    if analysis.right:
        return _right(analysis)
    parts = [_outcome(analysis) + _reason(analysis)]
    beside = [each.words for each in analysis.differences if each.share == 0]
    if beside:
        parts.append(f"Also, {join_words(beside)}.")
    parts += [_describe_view(analysis), _remedy(analysis)]
    return " ".join(part for part in parts if part)


def _right(analysis: Analysis) -> str:
    took = _voters(analysis, analysis.expected)
    start = f"{took} chose {analysis.expected!r}, as expected"
    if analysis.other is None or not math.isfinite(analysis.other_score):
        return f"{start}; no other gesture could be compared."
    return (
        f"{start}; the runner-up is {analysis.other!r}, {_farther(analysis)} "
        f"(confidence {analysis.confidence:.2f})."
    )


def _farther(analysis: Analysis) -> str:
    score, other = analysis.score, analysis.other_score
    return f"at distance {other:.2f} against {score:.2f}"


def _outcome(analysis: Analysis) -> str:
    if analysis.fault is not None:
        return f"Nothing was recognised because the keypoints are too poor: {analysis.fault}"
    if analysis.label is not None:
        wrong = _voters(analysis, analysis.nearest)
        return f"{wrong} chose {analysis.nearest!r} instead of {analysis.expected!r}"
    if analysis.between:
        between = f"take lies between {join_words([repr(each) for each in analysis.between])}"
        asked = len(analysis.between) == 2
        return f"The {between}" if asked else f"Nothing was recognised: the {between}"
    if analysis.nearest != analysis.expected:
        return f"Nothing was recognised; {analysis.nearest!r} was nearest"
    return (
        f"Nothing was recognised: {analysis.expected!r} was nearest, but the take is "
        f"{analysis.novelty:.1f} times as far from it as the limit allows"
    )


def _voters(analysis: Analysis, label: str) -> str:
    return f"Voters with {100 * analysis.support.get(label, 0.0):.0f} % of the weight"


def _reason(analysis: Analysis) -> str:
    if analysis.fault is not None:
        return "."
    cause = _cause(analysis)
    if not math.isfinite(analysis.score) and cause is not None and cause.kind == "hand_shape":
        return f" because {cause.words}."
    if not math.isfinite(analysis.score):
        return f": a keypoint that {analysis.expected!r} needs is missing or does not move."
    against = _describe_opposition(analysis)
    if cause is not None:
        return f" because {cause.words}" + (f" ({against})." if against else ".")
    return f"; {against}." if against else "."


def _describe_opposition(analysis: Analysis) -> str:
    """Return in words which voters contributed most against the expected gesture, if any."""
    largest = humanize_all(_opposing_voters(analysis)[:MOST_VOTERS_NAMED])
    return f"most against {analysis.expected!r}: {join_words(largest)}" if largest else ""


def _opposing_voters(analysis: Analysis) -> list[str]:
    """Return the voters against the expected gesture, those with the largest contribution first.

    If it was nearest but rejected, the voters with the largest shares of its score.
    """
    if analysis.nearest != analysis.expected:
        return [verdict.voter for verdict in analysis.verdicts if verdict.against > 0]
    beyond = [verdict for verdict in analysis.verdicts if verdict.share > 0]
    return [each.voter for each in sorted(beyond, key=lambda verdict: -verdict.share)]


def _cause(analysis: Analysis) -> Difference | None:
    """Return the difference that explains most, if any does."""
    strongest = analysis.verdicts[0].voter if analysis.verdicts else ""
    kinds = {"tempo": "tempo", "place": "place"} | dict.fromkeys(HAND_VOTER_NAMES, "hand_shape")
    causes = [each for each in analysis.differences if each.kind == kinds.get(strongest)]
    # A hand shape does not explain a decision by the movement.
    shaped = (
        strongest in HAND_VOTER_NAMES
        or analysis.nearest == analysis.expected
        or not math.isfinite(analysis.score)
    )
    causes += [
        each
        for each in analysis.differences
        if each.share > 0 and (shaped or each.kind != "hand_shape")
    ]
    return causes[0] if causes else None


def _describe_view(analysis: Analysis) -> str:
    """Return in words from where the demonstration was viewed, if it was turned."""
    if not analysis.view:
        return ""
    side = "left" if analysis.view > 0 else "right"
    return (
        f"The diver is turned to the own {side}, so the demonstration was turned by "
        f"{abs(analysis.view)} degrees before it was compared."
    )


def _remedy(analysis: Analysis) -> str:
    # A take that becomes a demonstration is recognised by construction: no remedy to name.
    found = [
        each
        for each in analysis.counterfactuals.found
        if not each.change.kind.endswith("demonstration")
    ]
    if found:
        return f"It would have been read as {analysis.expected!r} {found[0].change.words}."
    tried = analysis.counterfactuals.tried
    return (
        ""
        if analysis.counterfactuals.found or not tried
        else (f"None of {tried} changes tried would have turned it right.")
    )
