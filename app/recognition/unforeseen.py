"""How much farther real takes stray than the variants that stand for them in forecasts.

Calibration and the health report both forecast from variants, and both must allow for the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from app.recognition.variation import Person

UNFORESEEN: Final[Mapping[Person, float]] = MappingProxyType({"same": 0.15, "another": 0.2})
"""Scale by which margins of real takes differ from those of variants, by whose takes they are, see
`Forecast.of_margins`: others also draw a letter with other strokes, which no variant of one
demonstration can know. Measured on other people's recordings (`docs/results.md`, Health)."""
