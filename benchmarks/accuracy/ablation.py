"""Ablation: accuracy of profile ``full`` with one voter alone and with one voter left out.

One-shot accuracy on the recorded sets, user-independent where people are known. The voters are
switched off as an author would, by weight factors (`Tuning`), so that limit and unambiguous
traversals stay those of all voters together.

    python -m benchmarks.accuracy.ablation ../shared/data
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseError
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import Tuning
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.voters.registry import VOTER_NAMES
from benchmarks.arguments import set_arguments
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

ALL = "all together"


def choices() -> dict[str, Tuning]:
    """Return the weight factors of the voters by name of the choice."""
    alone = {
        f"{voter} alone": Tuning(weights={name: float(name == voter) for name in VOTER_NAMES})
        for voter in VOTER_NAMES
    }
    without = {f"without {voter}": Tuning(weights={voter: 0.0}) for voter in VOTER_NAMES}
    return {ALL: Tuning()} | alone | without


def ablate(recorded: RecordedSet, draws: int, queries: int, seed: int) -> dict[str, float]:
    """Return the share correct for each of the `choices`; a voter of weight 0 alone gets 0."""
    random = np.random.default_rng(seed)
    correct, asked = dict.fromkeys(choices(), 0), 0
    for _ in range(draws):
        person = random.choice(np.unique(recorded.people))
        own = recorded.people == person
        templates = [
            int(random.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in np.unique(recorded.labels)
        ]
        gestures = demonstrated(recorded, templates)
        votes = {name: FusedVote(gestures, tuning) for name, tuning in choices().items()}
        pool = np.setdiff1d(np.flatnonzero(~own if (~own).any() else own), templates)
        for query in random.choice(pool, min(queries, len(pool)), replace=False):
            asked += 1
            try:
                seen = condense(repair_poses(recorded.recordings[query]).trajectory)
            except PoseError:
                continue
            for name, vote in votes.items():
                result = vote.recognize(seen)
                correct[name] += result is not None and result.nearest == recorded.labels[query]
    return {name: count / asked for name, count in correct.items()}


def main() -> None:
    """Print one line per voter and one pair of columns per set: alone, and left out."""
    given = set_arguments(__doc__, draws=40, queries=25).parse_args()
    sets = [*recorded_sets(given.data / "trajectories", given.sets)]
    shares = [ablate(each, given.draws, given.queries, given.seed) for each in sets]
    print("| voter | " + " | ".join(each.name for each in sets) + " |")
    print("| --- " * (len(sets) + 1) + "|")
    print(f"| {ALL} | " + " | ".join(f"{share[ALL]:.1%}" for share in shares) + " |")
    for voter in VOTER_NAMES:
        cells = [f"{s[f'{voter} alone']:.1%} / {s[f'without {voter}']:.1%}" for s in shares]
        print(f"| `{voter}` | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
