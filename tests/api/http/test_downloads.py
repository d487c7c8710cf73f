"""Downloads have names that a shell takes without quotes."""

import pytest

from app.api.http.downloads import attachment


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("My gestures", "My-gestures.json"),
        ("Zeichen für Höhlen, 2. Fassung ✋", "Zeichen-fur-Hohlen-2.-Fassung.json"),
        ('"; rm -rf ~\r\nX: y', "rm--rf-X-y.json"),
        ("手势", "language.json"),
    ],
)
def test_a_name_is_one_word_of_a_command(name: str, shown: str) -> None:
    assert attachment(name, ".json") == f'attachment; filename="{shown}"'
