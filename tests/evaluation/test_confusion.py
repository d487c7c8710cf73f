"""The confusion matrix: its counts, as text and as a picture."""

import xml.etree.ElementTree as ElementTree

from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.confusion import REFUSED, ConfusionMatrix
from app.evaluation.confusion_chart import confusion_svg

LABELS = ("circle", "wedge", "<three & more>")
pairs = st.lists(st.tuples(st.sampled_from(LABELS), st.sampled_from([*LABELS, None])), min_size=1)


def matrix_of(answers: list[tuple[str, str | None]]) -> ConfusionMatrix:
    return ConfusionMatrix.of(
        LABELS, [shown for shown, _ in answers], [read for _, read in answers]
    )


@given(pairs)
def test_every_query_is_counted_once_in_the_row_of_what_was_shown(
    answers: list[tuple[str, str | None]],
) -> None:
    matrix = matrix_of(answers)
    rows = [sum(shown == label for shown, _ in answers) for label in LABELS]
    assert matrix.counts.sum(axis=1).tolist() == rows
    assert matrix.correct.correct == sum(shown == read for shown, read in answers)
    assert matrix.refused.correct == sum(read is None for _, read in answers)
    assert matrix.correct.asked == matrix.refused.asked == len(answers)


def test_text_has_a_row_for_each_gesture_and_a_column_for_refusals_only_where_there_are_any() -> (
    None
):
    read = matrix_of([("circle", "circle"), ("wedge", "circle")])
    lines = read.to_text().splitlines()
    assert [line.split()[0] for line in lines[1:3]] == ["circle", "wedge"]
    assert lines[2].split() == ["wedge", "1", ".", "."]
    assert REFUSED not in read.to_text()
    assert REFUSED in matrix_of([("circle", None)]).to_text().splitlines()[0]


@given(pairs)
def test_the_picture_is_valid_xml_that_holds_every_count_and_label(
    answers: list[tuple[str, str | None]],
) -> None:
    matrix = matrix_of(answers)
    root = ElementTree.fromstring(confusion_svg(matrix, "Profile full & more"))
    texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    numbers = sorted(int(text) for text in texts if text is not None and text.isdigit())
    assert numbers == sorted(int(count) for count in matrix.counts.ravel() if count)
    assert texts[0] == "Profile full & more"
    assert [texts.count(label) for label in LABELS] == [2, 2, 2]


def test_a_long_label_stays_inside_the_picture() -> None:
    label = "a gesture with a name that is as long as a label may possibly become in a language"
    root = ElementTree.fromstring(confusion_svg(ConfusionMatrix.of([label], [label], [label]), "t"))
    width = float(root.attrib["viewBox"].split()[2])
    squeezed = [float(e.attrib["textLength"]) for e in root.iter() if "textLength" in e.attrib]
    assert squeezed
    assert max(squeezed) < width
