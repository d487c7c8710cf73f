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
        "published": "benchmarks.methods.published:PublishedCode",
        "dtw": "benchmarks.methods.plain_warping:PlainWarping",
        "jackknife": "benchmarks.methods.jackknife:Jackknife",
        "point cloud": "benchmarks.methods.point_cloud:PointCloud",
        "hmm": "benchmarks.methods.hidden_markov:HiddenMarkov",
        "svm": "benchmarks.methods.support_vectors:SupportVectors",
        "crf": "benchmarks.methods.random_field:RandomField",
        "bi-lstm": "benchmarks.methods.bi_lstm:BiLstm",
    }
)

COSTLY: Final = ("published", "hmm", "svm", "crf", "bi-lstm")
"""Names of the methods that take long; all but the first are trained, in the extra ``bench``."""

METHODS: Final = (*PROFILES, *(name for name in _OTHERS if name not in COSTLY))
"""Names of the other methods that are compared."""


def find_method(name: str) -> Callable[[], Method]:
    """Find the class of a method: one of `METHODS`, or ``package.module:Class``.

    Only the packages of this method are imported: some are large, and in the extra ``bench``.

    Raises
    ------
    ModuleNotFoundError
        When its module, or a package of the extra ``bench``, is not installed.
    AttributeError
        When the module has no such class.

    """
    if name in PROFILES:
        return partial(OurProfile, name)
    module, _, of_class = _OTHERS.get(name, name).partition(":")
    factory: Callable[[], Method] = getattr(import_module(module), of_class)
    return factory
