"""Health check: predicts confusions, misses and false alarms of a language by simulated trials."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.explanation.pair_difference import PairDifference, compare_pair
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import PROFILES
from app.recognition.health.ambiguity import find_ambiguities
from app.recognition.health.embedding import embed_gestures
from app.recognition.health.false_alarms import FalseAlarm, find_false_alarms
from app.recognition.health.finding import Finding, check_demonstration, measure_visible_share
from app.recognition.health.known_signs import find_known_signs
from app.recognition.health.neighbours import (
    MOST_TOGETHER,
    find_neighbours,
    measure_step_distances,
)
from app.recognition.health.remedy import Remedy, TrialRunner, find_pair_remedies
from app.recognition.health.report import (
    MOST_CONFUSION,
    MOST_MISSED,
    GestureHealth,
    HealthReport,
    LandmarkHealth,
    LimitHealth,
    PairHealth,
)
from app.recognition.health.second_divers import advise_second_divers
from app.recognition.health.simulated_trials import SimulatedTrials
from app.recognition.health.trigger_health import (
    check_trigger,
    check_trigger_gestures,
    list_trigger_findings,
)
from app.recognition.health.viewing_angles import check_angles, find_blind_angles
from app.recognition.language.language import Language
from app.recognition.poses.sequence import FloatArray
from app.recognition.preprocessing.salience import measure_displacements
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variation import Person
from app.recognition.text.look_alikes import are_confusable, list_look_alikes

MOST_ALARMS = 0.1
"""Share of background motion from which a note is given. It is no error, because background
motion is rare between two salutes."""

DUPLICATE = 0.12
"""Fused distance of two demonstrations below which they are duplicates: less than between two takes
of one gesture by the same person; 1 is two typical gestures."""

TAKES = 16
"""Simulated takes of each gesture: the interval of a rate of 5 % is then about 2 to 12 %."""

EXAMPLES = 2
"""Examples of each kind of background motion."""

MOST_REMEDIED = 3
"""Findings for which remedies are computed, the worst first; a next check computes the others'."""

MOST_EXPLAINED = 100
"""Confused pairs with a finding of their own, the worst first; each costs two comparisons."""

SAME = ("movement", "hand shape", "sequence of hand shapes")
"""Common property of duplicates, by the number of held hand shapes."""

Progress = Callable[[str, int, int], None]
"""Called with the stage, the steps done and their number (0: unknown); an exception that it raises
ends the check."""


def check_health(
    language: Language,
    *,
    person: Person = "another",
    takes: int = TAKES,
    seed: int = 0,
    progress: Progress = lambda _stage, _done, _total: None,
    known_signs: Language | None = None,
) -> HealthReport:
    """Check a language before the dive.

    The same language, seed and number of takes give the same report. The time grows linearly with
    the number of gestures: beyond `neighbours.MOST_TOGETHER` each is tried among its nearest ones.

    Parameters
    ----------
    language
        The language. Its tuning applies; the profile is always ``full``, since ``paper`` rejects
        nothing.
    person
        The diver: the demonstrator, or another person.
    takes
        Of each gesture, at least 2.
    seed
        Of all random numbers.
    progress
        Called with stage, steps done and their number; may raise to cancel.
    known_signs
        Signs that divers know, with their meaning; gestures that look like one become findings.
        None: there is no such search.

    """
    if not language.gestures:
        nothing = Finding("empty", (), "the language has no gestures yet: add one", True)
        return HealthReport(
            language=language.name,
            revision=language.revision,
            person=person,
            takes=takes,
            gestures=(),
            pairs=(),
            findings=(nothing,),
            places=np.zeros((0, 2)),
        )
    recognizer = Recognizer(language, "full")
    shown = sum(gesture.trajectory is not None for gesture in language.gestures)
    advance = _count_steps(progress, "rehearsing", shown * takes)
    run_trials = TrialRunner(takes=takes, seed=seed, person=person, advance=advance)
    trials = run_trials(recognizer)
    read = find_false_alarms(
        recognizer, EXAMPLES, seed=seed, advance=_count_steps(progress, "accidental movements", 0)
    )
    neighbours = find_neighbours(recognizer)
    distances = _demonstrated_distances(recognizer, neighbours)
    angles = check_angles(
        recognizer, seed=seed, person=person, advance=_count_steps(progress, "turned divers", 0)
    )
    gestures = tuple(
        replace(_gesture_health(gesture, index, trials, read), angles=angles.get(index, ()))
        for index, gesture in enumerate(language.gestures)
    )
    pairs = [check_pairs(language, pair, trials, distances) for pair in _list_pairs(neighbours)]
    pairs.sort(key=_confusion_rate, reverse=True)
    searching = replace(run_trials, advance=_count_steps(progress, "remedies", 0))
    findings = [
        *_pair_findings(recognizer, pairs, trials, searching),
    ]
    explained = {label for finding in findings for label in finding.gestures}
    findings += _gesture_findings(language, gestures, explained)
    findings += _twin_findings(recognizer, pairs)
    findings += [
        each for health in gestures for each in find_blind_angles(health.label, health.angles)
    ]
    if person == "another":
        findings += advise_second_divers(language, gestures)
    if known_signs is not None:
        compare = _count_steps(progress, "known signs", len(gestures))
        findings += find_known_signs(language, known_signs, compare)
    trigger = (
        check_trigger_gestures(language, [each.missed for each in gestures], read)
        if language.trigger.kind == "gesture"
        else check_trigger(language.trigger, seed=seed)
    )
    findings += list_trigger_findings(language.trigger, trigger, language.gestures)
    findings += _label_findings(language.labels)
    findings += _profile_findings(language)
    compared = neighbours.shape[1] - 1
    if compared + 1 < len(gestures):
        findings.append(_neighbours_finding(len(gestures), compared))
    if language.grammar is not None:
        findings += [each.finding() for each in find_ambiguities(language.grammar)]
    return HealthReport(
        language=language.name,
        revision=language.revision,
        person=person,
        takes=takes,
        gestures=gestures,
        pairs=tuple(pairs),
        findings=tuple(sorted(findings, key=lambda finding: not finding.below_bar)),
        places=embed_gestures(_estimate_far_distances(recognizer, distances)),
        neighbours=None if compared + 1 == len(gestures) else compared,
        trigger=trigger,
        limit=LimitHealth.measure(recognizer),
    )


def _count_steps(progress: Progress, stage: str, total: int) -> Callable[[], None]:
    """Return a function that reports one more step of a stage; a total of 0 is unknown."""
    done = 0

    def advance() -> None:
        nonlocal done
        done += 1
        progress(stage, done, total)

    return advance


def _demonstrated_distances(recognizer: Recognizer, neighbours: npt.NDArray[np.intp]) -> FloatArray:
    """Compute the distances of demonstrations to gestures: ``(G, G)``; infinite where unknown."""
    gestures, vote = recognizer.language.gestures, recognizer.vote
    distances = np.full((len(gestures), len(gestures)), np.inf)
    for index, (gesture, near) in enumerate(zip(gestures, neighbours, strict=True)):
        if gesture.trajectory is not None:
            assert isinstance(vote, FusedVote)  # profile `full`
            among = vote if len(near) == len(gestures) else vote.among(near)
            distances[index, near] = among.compare(condense(gesture.trajectory)).scores
    return distances


def _list_pairs(neighbours: npt.NDArray[np.intp]) -> list[tuple[int, int]]:
    """List the pairs of gestures of which one is a neighbour of the other, each once."""
    one = np.repeat(np.arange(len(neighbours)), neighbours.shape[1])
    pairs = np.sort(np.column_stack([one, neighbours.ravel()]), axis=1)
    different = pairs[pairs[:, 0] != pairs[:, 1]]
    return [(first, second) for first, second in np.unique(different, axis=0).tolist()]


def _estimate_far_distances(recognizer: Recognizer, distances: FloatArray) -> FloatArray:
    """Return the distances with those of far pairs estimated from their paths, for the map."""
    if len(distances) <= MOST_TOGETHER:
        return distances
    paths = measure_step_distances(recognizer)
    known = np.isfinite(distances) & np.isfinite(paths) & (paths > 0)
    scale = float(np.median(distances[known] / paths[known])) if known.any() else 1.0
    return np.where(np.isfinite(distances), distances, scale * paths)


def _gesture_health(
    gesture: Gesture, index: int, trials: SimulatedTrials, read: Sequence[FalseAlarm]
) -> GestureHealth:
    shown, performer = gesture.trajectory, trials.performer(index)
    moved = {} if shown is None else measure_displacements(shown)
    taken = [alarm for alarm in read if alarm.taken and alarm.nearest == index]
    comparable = any(alarm.nearest is not None for alarm in read)
    return GestureHealth(
        label=gesture.label,
        seconds=None if shown is None else float(shown.time[-1] - shown.time[0]),
        landmarks=tuple(
            LandmarkHealth(name, moved[name], measure_visible_share(shown, name))
            for name in gesture.salient
            if shown is not None
        ),
        missed=None if performer is None else trials.missed(performer),
        refused=None if performer is None else trials.refused(performer),
        false_alarms=RateEstimate.of_count(len(taken), len(read)) if comparable else None,
        set_off_by=tuple(dict.fromkeys(alarm.kind for alarm in taken)),
    )


def check_pairs(
    language: Language, pair: tuple[int, int], trials: SimulatedTrials, distances: FloatArray
) -> PairHealth:
    """Estimate the confusion of two gestures.

    Parameters
    ----------
    language
        Of G gestures.
    pair
        Indices of the two.
    trials
        Trials of both; directions without trials get no estimate.
    distances
        ``(G, G)``: fused distance of each demonstration, a row, to every gesture; infinite where
        they were not compared.

    """

    def estimate(one: int, other: int) -> RateEstimate | None:
        performer = trials.performer(one)
        return None if performer is None else trials.confusion(performer, other)

    first, second = pair
    between = [each for each in (distances[pair], distances[second, first]) if np.isfinite(each)]
    return PairHealth(
        gestures=(language.labels[first], language.labels[second]),
        first_as_second=estimate(first, second),
        second_as_first=estimate(second, first),
        distance=float(np.mean(between)) if between else None,
    )


def _confusion_rate(pair: PairHealth) -> tuple[float, float]:
    confusion = pair.confusion
    return (confusion.rate, confusion.high) if confusion else (-1.0, -1.0)


def _pair_findings(
    recognizer: Recognizer,
    pairs: Sequence[PairHealth],
    trials: SimulatedTrials,
    run_trials: TrialRunner,
) -> list[Finding]:
    """Return the findings about confused pairs; `pairs` are sorted, the worst first."""
    language = recognizer.language
    findings: list[Finding] = []
    shapes = {gesture.label: len(gesture.held_shapes) for gesture in language.gestures}
    confused = [pair for pair in pairs if _confusion_rate(pair)[0] > MOST_CONFUSION]
    for pair in confused[:MOST_EXPLAINED]:
        first, second = (language.labels.index(label) for label in pair.gestures)
        differences = (
            compare_pair(recognizer, first, second),
            compare_pair(recognizer, second, first),
        )
        remedies: tuple[Remedy, ...] = ()
        both_shown = pair.first_as_second is not None and pair.second_as_first is not None
        if len(findings) < MOST_REMEDIED and both_shown:
            strokes = tuple(None if each is None else each.stroke for each in differences)
            remedies = find_pair_remedies(language, (first, second), trials, run_trials, strokes)
        findings.append(
            Finding(
                "duplicate" if _is_duplicate(pair) else "confused",
                pair.gestures,
                _confusion_message(pair, differences, shapes),
                below_bar=True,
                remedies=remedies,
            )
        )
    if (more := len(confused) - MOST_EXPLAINED) > 0:
        message = (
            f"{more} further pairs are confused as well, less often than the {MOST_EXPLAINED} worst"
        )
        findings.append(Finding("more_confused", (), message, below_bar=True))
    return findings


def _twin_findings(recognizer: Recognizer, pairs: Sequence[PairHealth]) -> Iterator[Finding]:
    """Yield a note for every two gestures that the hand shape alone tells apart."""
    labels = recognizer.language.labels
    twins = {frozenset(labels[index] for index in pair) for pair in recognizer.vote.shape_twins}
    for pair in pairs:
        if frozenset(pair.gestures) not in twins or pair.confusion is None:
            continue
        first, second = pair.gestures
        yield Finding(
            "hand_shape_only",
            pair.gestures,
            f"{first} and {second} are the same movement, told apart by the hand shape alone: "
            f"{pair.confusion.words} are confused where the hand is seen; where it is not, the "
            "robot refuses both",
        )


def _neighbours_finding(count: int, compared: int) -> Finding:
    message = (
        f"of {count} gestures each is tried among its {compared} nearest ones, because trying all "
        "pairs would take hours: confusions of pairs farther apart are left out"
    )
    return Finding("neighbours_only", (), message)


def _is_duplicate(pair: PairHealth) -> bool:
    return pair.distance is not None and pair.distance < DUPLICATE


def _confusion_message(
    pair: PairHealth,
    differences: tuple[PairDifference | None, PairDifference | None],
    shapes: Mapping[str, int],
) -> str:
    """Return the message about a confusion; `shapes`: numbers of held hand shapes by label."""
    first, second = pair.gestures
    if _is_duplicate(pair):
        same = SAME[shapes[first]]
        return (
            f"{first} and {second} are the same {same}, so the robot cannot distinguish them: "
            f"change or remove one of them"
        )
    confusion, forth = pair.confusion, pair.confusion is pair.first_as_second
    assert confusion is not None  # the caller checks it
    one, other = (first, second) if forth else (second, first)
    differing = differences[0 if forth else 1]
    where = ""
    if differing is not None:
        where = f": compared with {other}, {differing.words}"
    return f"{one} is read as {other} in {confusion.words}{where}"


def _label_findings(labels: Sequence[str]) -> Iterator[Finding]:
    for one, other in list_look_alikes(labels):
        yield Finding(
            "look_alike",
            (one, other),
            f"the labels {one} and {other} look alike, so a slate does not tell which is meant; "
            "rename one of the two gestures",
            below_bar=are_confusable(one, other),
        )


def _profile_findings(language: Language) -> list[Finding]:
    if PROFILES[language.profile].rejects:
        return []
    message = (
        f"the language uses the profile {language.profile}, which rejects nothing, while this "
        "report is for the profile full: choose the profile full before a dive"
    )
    return [Finding("unrejecting", (), message, below_bar=True)]


def _gesture_findings(
    language: Language, gestures: Sequence[GestureHealth], explained: Collection[str]
) -> list[Finding]:
    """Return the findings about single gestures; `explained` ones have a finding as a pair."""
    findings: list[Finding] = []
    for gesture, health in zip(language.gestures, gestures, strict=True):
        findings += check_demonstration(gesture, salutes=language.trigger.kind == "salute")
        explained_by_pair = health.label in explained
        if not explained_by_pair and health.missed is not None and health.missed.rate > MOST_MISSED:
            message = f"{health.label} is not recognised in {health.missed.words}"
            findings.append(Finding("missed", (health.label,), message, below_bar=True))
        if health.false_alarms is not None and health.false_alarms.rate > MOST_ALARMS:
            message = (
                f"{health.label} has false alarms in {health.false_alarms.rate:.0%} of simulated "
                f"background motion: {', '.join(health.set_off_by)}"
            )
            findings.append(Finding("accidental", (health.label,), message))
    return findings
