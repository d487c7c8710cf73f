"""How real takes stray from the variants that stand for them in forecasts.

Calibration and the health report both forecast from variants, and both must allow for the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from app.recognition.simulation.variation import Person


@dataclass(frozen=True)
class VariantBias:
    """What no variant of one demonstration can tell.

    Attributes
    ----------
    scatter
        Scale > 0 of the logistic distribution of real takes' margins about the mean of the
        variants', see `RateEstimate.of_margins`.
    otherwise
        Share in [0, 1] of takes that are not what was shown: a letter drawn with other strokes,
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
"""By whose takes they are: the likeliest on recorded takes of five sets, where the scatter is from
0.25 to 0.3 for either, and from 0.03 to 0.05 of other people's takes are not what was shown
(`docs/health.md`)."""
