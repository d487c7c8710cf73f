"""Command ``osg-studio evaluate``: runs the paper's protocols on a language or labelled clips."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.clip_argument import (
    FrameRateOption,
    FrameSizeOption,
    LandmarkOption,
    TriggerOption,
    TurnOption,
    read_options,
)
from app.cli.terminal import progress_bar, tell
from app.evaluation.confusion import ConfusionMatrix, confusion_svg
from app.evaluation.labelled_takes import LAYOUTS, Collection, collect_takes, labelled_files
from app.evaluation.one_shot import one_shot, recognize_takes, recognize_variants
from app.recognition import Language
from app.recognition.gestures.profile import PROFILES
from app.recognition.simulation.variation import Person
from app.recognition.triggers.trigger import SALUTE

DEFAULT_VARIANTS = 50
"""Variants of each gesture; the paper shows each of its eight gestures as often."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Result of one profile for one kind of queries."""

    profile: str
    asked: str
    matrix: ConfusionMatrix

    def to_text(self) -> str:
        """Format accuracy, interval and confusion matrix as text."""
        correct, refused = self.matrix.correct, self.matrix.refused
        head = f"profile {self.profile}, {self.asked}: {correct} of {correct.asked} correct"
        if refused.correct:
            head += f", {refused.correct} rejected"
        if (asked := self.matrix.asked_back).asked:
            head += f", {asked.asked} asked back, {asked.correct} of them with the right gesture"
        return f"{head}\n\n{self.matrix.to_text()}\n"

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain JSON types."""
        return {
            "profile": self.profile,
            "asked": self.asked,
            "correct": self.matrix.correct.to_dict(),
            "refused": self.matrix.refused.to_dict(),
            "asked_back": self.matrix.asked_back.to_dict(),
            "confusion": self.matrix.to_dict(),
        }


def evaluate(
    source: Annotated[
        Path,
        typer.Argument(
            help="A language file, which recognises variants of its own gestures. Or a folder of "
            "labelled clips, recordings or keypoint files: each take in turn is the demonstration.",
            metavar="FILE.json|FOLDER",
        ),
    ],
    profile: Annotated[
        list[str] | None, typer.Option(help=f"Of {', '.join(PROFILES)}; repeat for more.")
    ] = None,
    language: Annotated[
        Path | None,
        typer.Option(help="With a folder: recognise the clips by this language."),
    ] = None,
    trigger: TriggerOption = None,
    layout: Annotated[
        str | None,
        typer.Option(help=f"Position of label and person in a path, as in {LAYOUTS[-1]}."),
    ] = None,
    variants: Annotated[
        int, typer.Option(min=1, help="With a language file: variants of each gesture.")
    ] = DEFAULT_VARIANTS,
    person: Annotated[
        Person, typer.Option(help="With a language file: person whose takes are simulated.")
    ] = "same",
    seed: Annotated[int, typer.Option(min=0, help="Random seed of the variants.")] = 0,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
    turn: TurnOption = 0,
    picture: Annotated[
        Path | None, typer.Option(help="SVG to write; several confusion matrices get numbers.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Measure how often gestures are recognised correctly, with interval and confusion matrix."""
    profiles = profile or list(PROFILES)
    held = trigger or language
    problems: dict[str, str] = {}
    if source.is_dir():
        with progress_bar("clips") as advance:
            collection = collect_takes(
                labelled_files(source, layout),
                options=read_options(frame_rate, frame_size, landmark, turn),
                trigger=SALUTE if held is None else Language.load(held).trigger,
                progress=advance,
            )
        problems = collection.problems
        results = list(_evaluate_takes(collection, profiles, language, problems))
    else:
        results = list(_evaluate_variants(Language.load(source), profiles, variants, person, seed))
    if as_json:
        report = {
            "source": str(source),
            "findings": [result.to_dict() for result in results],
            "problems": problems,
        }
        typer.echo(json.dumps(report, allow_nan=False))
    else:
        typer.echo("\n".join(result.to_text() for result in results), nl=False)
    for place, problem in problems.items():
        tell(f"{place}: {problem}")
    if picture is not None:
        _draw(picture, results)


def _evaluate_variants(
    language: Language, profiles: list[str], count: int, person: Person, seed: int
) -> Iterator[Evaluation]:
    for profile in profiles:
        with progress_bar(f"profile {profile}") as advance:
            matrix = recognize_variants(
                language,
                count,
                profile=profile,
                seed=seed,
                person=person,
                progress=advance,
            )
        yield Evaluation(
            profile, f"{count} variants of each gesture, {person} person, seed {seed}", matrix
        )


def _evaluate_takes(
    collection: Collection, profiles: list[str], language: Path | None, problems: dict[str, str]
) -> Iterator[Evaluation]:
    given = None if language is None else Language.load(language)
    takes = collection.takes
    for profile in profiles:
        with progress_bar(f"profile {profile}") as advance:
            if given is not None:
                matrix = recognize_takes(given, takes, profile=profile, progress=advance)
                yield Evaluation(profile, f"takes named by {given.name}", matrix)
                continue
            result = one_shot(takes, profile=profile, progress=advance)
        problems |= {
            place: f"used as a query only, not as a demonstration: {reason}"
            for place, reason in result.unusable.items()
        }
        several_people = len({take.person for take in takes}) > 1
        matrices = {"same person" if several_people else "any person": result.same_person}
        if several_people:
            matrices["other people"] = result.other_people
        for who, matrix in matrices.items():
            yield Evaluation(profile, f"{who}, {result.languages} languages of one take", matrix)


def _draw(picture: Path, results: list[Evaluation]) -> None:
    for number, result in enumerate(results, start=1):
        name = picture.name if len(results) == 1 else f"{picture.stem}-{number}{picture.suffix}"
        target = picture.with_name(name)
        title = f"Profile {result.profile}, {result.asked}"
        target.write_text(confusion_svg(result.matrix, title), encoding="utf-8")
        tell(f"{target}: {title}")
