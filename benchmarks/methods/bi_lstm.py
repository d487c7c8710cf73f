"""A recurrent network in the manner of Ghader et al. (2023): three bidirectional LSTM layers."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

os.environ.setdefault("KERAS_BACKEND", "jax")

import jax
import keras

from app.recognition.poses.sequence import FloatArray
from benchmarks.methods.trained import TrainedOnVariants

UNITS = 32
"""Hidden units per direction and layer: a thousand training sequences support no larger network."""

EPOCHS = 15
BATCH = 64

# Compiling takes longer than training, so compiled networks are cached by their shape, also for
# later processes.
jax.config.update("jax_compilation_cache_dir", str(Path(tempfile.gettempdir()) / "osg-bench-jax"))


class BiLstm(TrainedOnVariants):
    """Three bidirectional layers, then one weight for each gesture."""

    def train(self, sequences: list[FloatArray]) -> None:
        """Fit the network to all variants, from random weights."""
        keras.utils.set_random_seed(0)
        rows = np.concatenate(sequences).astype(np.float32)
        owners = np.repeat(np.arange(len(sequences)), [len(each) for each in sequences])
        layers = [
            keras.layers.Bidirectional(keras.layers.LSTM(UNITS, return_sequences=more))
            for more in (True, True, False)
        ]
        self._network: Any = keras.Sequential([*layers, keras.layers.Dense(len(sequences))])
        loss = keras.losses.SparseCategoricalCrossentropy(from_logits=True)
        self._network.compile(keras.optimizers.Adam(0.005), loss)
        self._network.fit(rows, owners, batch_size=BATCH, epochs=EPOCHS, verbose=0)

    def likeliest(self, sequence: FloatArray) -> int:
        """Return the gesture with the largest output."""
        return int(self._network.predict_on_batch(sequence[None].astype(np.float32))[0].argmax())
