"""The command ``osg-studio evaluate``: the paper's protocols, and one's own labelled clips."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.clip_argument import (
    FrameRateOption,
    FrameSizeOption,
    LandmarkOption,
    keypoint_options,
)
from app.cli.terminal import people, progress_bar
from app.evaluation.confusion import ConfusionMatrix
from app.evaluation.confusion_chart import confusion_svg
from app.evaluation.labelled_files import LAYOUTS, labelled_files
from app.evaluation.labelled_takes import Collection, collected
from app.evaluation.one_shot import one_shot, read_by
from app.evaluation.protocols import recognised_variants
from app.recognition import Language
from app.recognition.gestures.profile import PROFILES

DEFAULT_VARIANTS = 50
"""Of each gesture, as often as the paper shows each of its eight."""


class Person(str, Enum):
    """Whose takes the variants resemble."""

    same = "same"
    another = "another"


@dataclass(frozen=True, eq=False)
class Finding:
    """What one profile made of one kind of queries."""

    profile: str
    asked: str
    matrix: ConfusionMatrix

    def to_text(self) -> str:
        """Return accuracy, interval and confusion matrix for a person."""
        correct, refused = self.matrix.correct, self.matrix.refused
        head = f"profile {self.profile}, {self.asked}: {correct} of {correct.asked} correct"
        if refused.correct:
            head += f", {refused.correct} without a label"
        return f"{head}\n\n{self.matrix.to_text()}\n"

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "profile": self.profile,
            "asked": self.asked,
            "correct": self.matrix.correct.to_dict(),
            "refused": self.matrix.refused.to_dict(),
            "confusion": self.matrix.to_dict(),
        }


def evaluate(
    source: Annotated[
        Path,
        typer.Argument(
            help="A language file: it names variants of its own gestures. Or a folder of labelled "
            "clips, saved recordings or keypoint files: every take in turn is the demonstration.",
            metavar="FILE.json|FOLDER",
        ),
    ],
    profile: Annotated[
        list[str] | None, typer.Option(help=f"Of {', '.join(PROFILES)}; repeat for more.")
    ] = None,
    language: Annotated[
        Path | None,
        typer.Option(help="With a folder: this language names the clips, none is demonstration."),
    ] = None,
    layout: Annotated[
        str | None,
        typer.Option(help=f"Where label and person stand in a path, as in {LAYOUTS[-1]}."),
    ] = None,
    variants: Annotated[
        int, typer.Option(min=1, help="With a language file: variants of each gesture.")
    ] = DEFAULT_VARIANTS,
    person: Annotated[
        Person, typer.Option(help="With a language file: whose takes the variants resemble.")
    ] = Person.same,
    seed: Annotated[int, typer.Option(min=0, help="Of the variants.")] = 0,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
    picture: Annotated[
        Path | None, typer.Option(help="SVG to write; several confusion matrices get numbers.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Measure how often gestures are named correctly, with interval and confusion matrix."""
    profiles = profile or list(PROFILES)
    problems: dict[str, str] = {}
    if source.is_dir():
        keypoints = keypoint_options(frame_rate, frame_size, landmark)
        with progress_bar("clips") as advance:
            collection = collected(
                labelled_files(source, layout), keypoints=keypoints, progress=advance
            )
        problems = collection.problems
        findings = list(_evaluate_takes(collection, profiles, language, problems))
    else:
        findings = list(_evaluate_variants(Language.load(source), profiles, variants, person, seed))
    if as_json:
        report = {
            "source": str(source),
            "findings": [finding.to_dict() for finding in findings],
            "problems": problems,
        }
        typer.echo(json.dumps(report, allow_nan=False))
    else:
        typer.echo("\n".join(finding.to_text() for finding in findings), nl=False)
    for place, problem in problems.items():
        people.print(f"{place}: {problem}", markup=False)
    if picture is not None:
        _draw(picture, findings)


def _evaluate_variants(
    language: Language, profiles: list[str], count: int, person: Person, seed: int
) -> Iterator[Finding]:
    for profile in profiles:
        with progress_bar(f"profile {profile}") as advance:
            matrix = recognised_variants(
                language,
                count,
                profile=profile,
                seed=seed,
                person=person.value,
                progress=advance,
            )
        yield Finding(
            profile, f"{count} variants of each gesture, {person.value} person, seed {seed}", matrix
        )


def _evaluate_takes(
    collection: Collection, profiles: list[str], language: Path | None, problems: dict[str, str]
) -> Iterator[Finding]:
    given = None if language is None else Language.load(language)
    takes = collection.takes
    for profile in profiles:
        with progress_bar(f"profile {profile}") as advance:
            if given is not None:
                matrix = read_by(given, takes, profile=profile, progress=advance)
                yield Finding(profile, f"takes named by {given.name}", matrix)
                continue
            result = one_shot(takes, profile=profile, progress=advance)
        problems |= {
            place: f"no demonstration, only asked for: {reason}"
            for place, reason in result.unusable.items()
        }
        told_apart = len({take.person for take in takes}) > 1
        own = "same person" if told_apart else "whoever it is by"
        yield Finding(
            profile, f"{own}, {result.languages} languages of one take", result.same_person
        )
        if told_apart:
            yield Finding(
                profile,
                f"other people, {result.languages} languages of one take",
                result.other_people,
            )


def _draw(picture: Path, findings: list[Finding]) -> None:
    for number, finding in enumerate(findings, start=1):
        name = picture.name if len(findings) == 1 else f"{picture.stem}-{number}{picture.suffix}"
        target = picture.with_name(name)
        title = f"Profile {finding.profile}, {finding.asked}"
        target.write_text(confusion_svg(finding.matrix, title), encoding="utf-8")
        people.print(f"{target}: {title}", markup=False)
