"""Invited takes: how many go live unasked, of right gestures and of wrong ones, by confidence.

A language is shown by one person, or by three; takes of people who show nothing are sent as their
own gesture (`right`), and as another one of the language (`wrong`). A take goes live unasked if it
is read as what it was sent as, with at least a confidence. `DOUBT` of the studio is 0.25.

    python -m benchmarks.invited_takes ../shared/data --draws 5 --sets utd_other utkinect
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from app.evaluation.share import Share
from app.recognition import Language, Recognizer
from benchmarks.accuracy.people import define, recognize
from benchmarks.arguments import set_arguments
from benchmarks.sets.every_set import all_sets, count_people
from benchmarks.sets.one_shot_draws import draw_several, draws

CONFIDENCES = (0.0, 0.25, 0.5, 0.75)
"""Least confidences that are compared; 0: any take that is read as what it was sent as."""

PEOPLE = (1, 3)


def main() -> None:
    """Print one row for each set and number of people."""
    given = set_arguments(__doc__, draws=5, queries=60).parse_args()
    columns = " | ".join(f"right, wrong from {each:.0%}" for each in CONFIDENCES)
    print(f"| set | shown by | n | {columns} |\n{'| --- ' * (3 + len(CONFIDENCES))}|")
    for recorded in all_sets(given.data / "trajectories", given.sets):
        if count_people(recorded) is None:
            continue
        generator = np.random.default_rng(given.seed)
        live: dict[tuple[int, float], list[tuple[bool, bool]]] = defaultdict(list)
        for number, chosen in enumerate(draws(recorded, given.draws, given.queries, given.seed)):
            several = draw_several(
                recorded, chosen, max(PEOPLE), given.queries, given.seed + number
            )
            for people in PEOPLE:
                gestures = [define(recorded, row) for row in several.rows(people)]
                recognizer = Recognizer(Language(recorded.name, gestures), "full")
                for result, label in recognize(recognizer, recorded, several.queries):
                    others = [each for each in recognizer.language.labels if each != label]
                    wrong = str(generator.choice(others))
                    for least in CONFIDENCES:
                        sure = result is not None and result.confidence >= least
                        read = result.label if result is not None and sure else None
                        live[people, least].append((read == label, read == wrong))
        for people in PEOPLE:
            cells = []
            for least in CONFIDENCES:
                right, wrong = np.sum(live[people, least], axis=0).tolist()
                asked = len(live[people, least])
                cells.append(f"{Share(right, asked)}, {Share(wrong, asked)}")
            print(f"| {recorded.name} | {people} | {asked} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
