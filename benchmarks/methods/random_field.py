"""A linear-chain conditional random field that names the gesture at every step."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pycrfsuite

from app.recognition.poses.sequence import FloatArray
from benchmarks.methods.trained import TrainedOnVariants

LEVELS = 7
"""Levels that a coordinate is divided into, because the field's weights are linear, but a gesture
is not a linear function of the hand's position."""

REACH = 2.0
"""Largest coordinate distinguished, in sizes."""

PHASES = 8
"""Phases of a gesture, each with its own weights, because positions change along the way."""

ROUNDS = 40
"""Iterations of L-BFGS."""


class RandomField(TrainedOnVariants):
    """Each step is described by the level of each coordinate in each phase."""

    def train(self, sequences: list[FloatArray]) -> None:
        """Fit the field to all variants."""
        trainer = pycrfsuite.Trainer(verbose=False)
        trainer.set_params({"c1": 0.0, "c2": 0.1, "max_iterations": ROUNDS})
        for gesture, variants in enumerate(sequences):
            for sequence in variants:
                trainer.append(_attributes(sequence), [str(gesture)] * len(sequence))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "field"
            trainer.train(str(path))
            # The tagger reads the model's memory without holding a reference to it.
            self._model = path.read_bytes()
        self._tagger = pycrfsuite.Tagger()
        self._tagger.open_inmemory(self._model)

    def likeliest(self, sequence: FloatArray) -> int:
        """Return the most frequent gesture label on the likeliest path through the field."""
        named = np.array(self._tagger.tag(_attributes(sequence)), dtype=int)
        return int(np.bincount(named).argmax())


def _attributes(sequence: FloatArray) -> list[list[str]]:
    """Return the level of each coordinate at each step."""
    shares = (np.clip(sequence, -REACH, REACH) + REACH) / (2 * REACH)
    levels = np.rint(shares * (LEVELS - 1)).astype(int)
    return [
        [f"{PHASES * step // len(levels)}:{place}:{level}" for place, level in enumerate(row)]
        for step, row in enumerate(levels.tolist())
    ]
