"""Registry of the one-shot recognition methods that are compared."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from types import MappingProxyType
from typing import Final

from app.recognition.gestures.profile import PROFILES
from benchmarks.methods.base import Method
from benchmarks.methods.ours import OurProfile

_OTHERS: Final = MappingProxyType(
    {
        "published": "published.PublishedCode",
        "dtw": "plain_warping.PlainWarping",
        "jackknife": "jackknife.Jackknife",
        "point cloud": "point_cloud.PointCloud",
        "hmm": "hidden_markov.HiddenMarkov",
        "svm": "support_vectors.SupportVectors",
        "crf": "random_field.RandomField",
        "bi-lstm": "bi_lstm.BiLstm",
    }
)

METHODS: Final = (*PROFILES, *_OTHERS)
"""Names for `new_method`."""


def new_method(name: str) -> Method:
    """Make a method that has not seen a gesture yet.

    Only the packages of this method are imported: some are large, and in the extra ``bench``.

    Raises
    ------
    ModuleNotFoundError
        When a package of the extra ``bench`` is not installed.

    """
    factory: Callable[[], Method]
    if name in PROFILES:
        factory = partial(OurProfile, name)
    else:
        module, of_class = _OTHERS[name].split(".")
        factory = getattr(import_module(f"benchmarks.methods.{module}"), of_class)
    return factory()
