"""The page of the demo: whatever the words are, they are text."""

import pytest
from matplotlib.figure import Figure

from anisogran.demo.page import heading, page, paragraph, picture, table


@pytest.mark.hard_case("S9")
def test_no_word_becomes_markup():
    word = "<script>alert('=1+1')</script> & \"x\""
    parts = [heading(word), paragraph(word), table([word], [[word]]), picture(Figure(figsize=(1, 1)), word)]
    text = page(word, parts)
    assert "<script" not in text
    assert text.count("&lt;script&gt;") == 8  # title twice, heading, paragraph, two cells, and twice at the picture
