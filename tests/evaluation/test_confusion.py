"""The confusion matrix: its counts, as text and as a picture."""

import xml.etree.ElementTree as ElementTree
from itertools import permutations

from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.confusion import NONE, REFUSED, Answer, ConfusionMatrix, confusion_svg
from app.evaluation.share import Share

LABELS = ("circle", "wedge", "<three & more>")
pairs = st.lists(
    st.tuples(
        st.sampled_from(LABELS),
        st.sampled_from([*LABELS, None, *permutations(LABELS, 2)]),
    ),
    min_size=1,
)


def matrix_of(answers: list[tuple[str, Answer]]) -> ConfusionMatrix:
    return ConfusionMatrix.of(
        LABELS, [shown for shown, _ in answers], [read for _, read in answers]
    )


@given(pairs)
def test_every_query_is_counted_once_in_the_row_of_what_was_shown(
    answers: list[tuple[str, Answer]],
) -> None:
    matrix = matrix_of(answers)
    rows = [sum(shown == label for shown, _ in answers) for label in LABELS]
    assert matrix.counts.sum(axis=1).tolist() == rows
    assert matrix.correct.correct == sum(shown == read for shown, read in answers)
    assert matrix.refused.correct == sum(read is None for _, read in answers)
    assert matrix.correct.asked == matrix.refused.asked == len(answers)


@given(pairs)
def test_a_pair_is_neither_right_nor_rejected_nor_a_wrong_label(
    answers: list[tuple[str, Answer]],
) -> None:
    matrix = matrix_of(answers)
    asked = [(shown, read) for shown, read in answers if isinstance(read, tuple)]
    assert matrix.asked_back.asked == len(asked)
    assert matrix.asked_back.correct == sum(shown in read for shown, read in asked)
    wrong = int(matrix.counts[:, :-1].sum()) - matrix.correct.correct
    parts = (matrix.correct.correct, wrong, matrix.refused.correct, matrix.asked_back.asked)
    assert sum(parts) == len(answers)
    rows = [[shown for shown, _ in asked].count(label) for label in LABELS]
    assert [sum(row) for row in matrix.to_dict()["pairs"]] == rows


def test_a_refusal_of_what_shows_none_of_the_gestures_is_right() -> None:
    shown = [NONE, NONE, NONE, "circle"]
    read: list[Answer] = [None, "circle", ("circle", "line"), "circle"]
    matrix = ConfusionMatrix.of(["circle", "line", NONE], shown, read)
    assert matrix.correct == Share(2, 4)
    assert (matrix.refused.correct, matrix.asked_back) == (0, Share(0, 1))


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
    answers: list[tuple[str, Answer]],
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
