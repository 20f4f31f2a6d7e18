"""Tables of texts on a page."""

from pathlib import Path

from markupsafe import Markup

import ryusa.study
from ryusa.study.html import template
from ryusa.study.printed_table import PrintedCell, PrintedTable

TABLE = PrintedTable(
    ("run", "a\n(m)"),
    [("x < y", "1"), (PrintedCell(Markup("<b>z</b>"), "id"), PrintedCell("2", "no", 'said "so"'))],
    frozenset({"run"}),
)


def shown(table):
    return template(Path(ryusa.study.__file__).with_name("pieces.html")).module.table(table, "means", "many")


def test_words_begin_at_the_left_and_numbers_end_at_the_right():
    page = shown(TABLE)
    assert '<table class="many">' in page
    assert '<th>run</th><th class="n">a\n(m)</th>' in page
    assert "<td>x &lt; y</td>" in page
    assert '<td class="n">1</td>' in page


def test_a_cell_has_its_own_look_and_tip_beside_that_of_its_column():
    page = shown(TABLE)
    assert '<td class="id"><b>z</b></td>' in page
    assert '<td class="n no" title="said &#34;so&#34;">2</td>' in page


def test_some_columns_alone():
    assert "x &lt; y" not in shown(TABLE.only("a\n(m)"))
