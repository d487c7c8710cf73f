"""The median is numpy's."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.median import median


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40))
def test_it_is_numpys(numbers: list[float]) -> None:
    assert median(np.array(numbers)) == np.median(numbers)
