"""Variant bias: how real takes differ from simulated variants, for estimated rates.

Used by both calibration and the check.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from app.recognition.simulation.variation import Person


@dataclass(frozen=True)
class VariantBias:
    """Measured differences between real takes and variants of one demonstration.

    Attributes
    ----------
    scatter
        Scale > 0 of the logistic distribution of real takes' margins about the mean of the
        variants', see `RateEstimate.of_margins`.
    otherwise
        Share in [0, 1] of takes that show something else: a letter drawn with other strokes,
        another sign.

    """

    scatter: float
    otherwise: float


VARIANT_BIASES: Final[Mapping[Person, VariantBias]] = MappingProxyType(
    {
        "same": VariantBias(scatter=0.25, otherwise=0.003),
        "another": VariantBias(scatter=0.25, otherwise=0.04),
    }
)
"""By performer: maximum likelihood on recorded takes of five sets, where the scatter is 0.25 to 0.3
for either, and 0.03 to 0.05 of other people's takes show something else
(`benchmarks/studies/predictions.md`)."""
