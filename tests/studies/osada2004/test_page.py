import base64
import io
import json
from dataclasses import replace
from html import unescape as html_unescape
from html.parser import HTMLParser

import pytest
from PIL import Image, ImageChops

from ryusa.cli.many_runs import print_counts
from ryusa.errors import ResultsError
from ryusa.running import disk
from ryusa.study import Level, Outcome, Plan, html, page
from ryusa.study.entry import plain_entry
from ryusa.study.page import write
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import PAPER

KEYS = {
    "id", "verdict", "outcome", "statement", "settings", "decided_by", "trials", "caution", "condition",
}  # fmt: skip
VOID = {"meta", "img", "br", "hr", "link", "input"}


class Reader(HTMLParser):
    """Collects tags, addresses, anchors and text; notes what is not closed."""

    def __init__(self):
        super().__init__()
        self.open, self.tags, self.addresses, self.ids, self.text = [], set(), [], [], ""

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        about = dict(attrs)
        self.addresses += [about[name] for name in ("src", "href") if name in about]
        self.ids += [about["id"]] if "id" in about else []
        assert not [name for name in about if name.startswith("on")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def read(ledger):
    reader = Reader()
    text = (ledger.folder / "ledger.html").read_text(encoding="utf-8")
    reader.feed(text)
    assert not reader.open
    return reader, text


def test_the_json_has_every_key_and_no_nan(every_word):
    files = write(every_word, every_word.folder / "copies" / "copy.json")
    assert [one.name for one in files] == ["ledger.html", "ledger.json", "copy.json"]

    def refuse(word):
        raise AssertionError(word)

    text = files[1].read_text(encoding="utf-8")
    plain = json.loads(text, parse_constant=refuse)
    assert text == files[2].read_text(encoding="utf-8")
    assert {one["id"]: one["verdict"] for one in plain["findings"]} == {
        "fig4": "undecided, no setting was judged",
        "fig7": "reproduced as shipped, in 6 of 12 settings, "
        "only if friction angle 10 deg (6 of 6 settings, none of 6 others)",
        "fig8": "not reproduced as shipped, and in none of 2 settings",
        "fig12": "contradicts its own equations; it holds in 1 of 1 setting",
        "fig14": "undecided as shipped, the only setting",
        "fig20": "reproduced as shipped, in 2 of 2 settings",
        "eq13": "proposal falls short as shipped, the only setting",  # it is no claim
    }
    for one in plain["findings"]:
        assert set(one) >= KEYS
        assert isinstance(one["settings"], dict)
        for trial in one["trials"]:
            assert set(trial) >= {"value", "low", "high", "unit", "n", "how", "asked", "outcome"}
    assert {"ryusa", "commit", "packages", "python", "machine", "made"} <= set(plain["provenance"])
    by_id = {one["id"]: one for one in plain["findings"]}
    assert by_id["fig14"]["trials"][0]["value"] is None
    assert by_id["eq13"]["trials"][0]["note"] == "stands as a wall"
    assert by_id["fig20"]["pictures"] == ["fig20/fig20.png"]


def test_the_page_is_complete_self_contained_and_escaped(every_word):
    write(every_word)
    reader, text = read(every_word)
    assert "script" not in reader.tags
    assert "49" not in reader.text.split("{{ 7 * 7 }}")[0][-200:]
    assert "alert('x')" in reader.text  # as text
    for address in reader.addresses:
        assert address.startswith(("#", "data:image/png;base64,"))
    assert "http" not in text
    assert "url(" not in text
    anchors = [one[1:] for one in reader.addresses if one.startswith("#")]
    assert set(anchors) <= set(reader.ids)
    assert len(reader.ids) == len(set(reader.ids))


def test_axe_finds_no_fault_on_the_page(every_word, faults_of):
    write(every_word)
    assert faults_of(every_word.folder / "ledger.html") == []


def test_every_claim_has_a_section_its_verdict_in_words_and_its_statement(every_word):
    write(every_word)
    reader, _ = read(every_word)
    assert {row.id for row in every_word.entries} <= set(reader.ids)
    for row in every_word.entries:
        assert str(PAPER.said(plain_entry(PAPER, row, every_word.folder))) in reader.text
        assert CLAIMS[row.id].says in reader.text
    assert "stands as a wall" in reader.text
    assert "a band of 10 cannot hold 100" in reader.text
    assert "1 of 2 runs failed" in reader.text
    assert "no number" in reader.text
    assert "2 of the 3 runs were made by other states of the code" in reader.text
    assert "2 by bbbbbbbbbbbb with changes." in reader.text
    assert "could not be carried out" in reader.text


def test_what_the_paper_proposes_is_not_counted_among_what_it_claims(every_word, capsys):
    outcomes = [row.outcome for row in every_word.entries]
    assert outcomes.count(Outcome.FAILS) == 2  # a claim, and the proposal eq13
    print_counts(every_word)
    counted = capsys.readouterr().out.strip().split("; ")
    falls_short, not_reproduced = "proposal falls short as shipped", "not reproduced as shipped"
    assert {f"1 {not_reproduced} (none holds in most settings)", f"1 {falls_short}"} <= set(counted)
    assert sum(int(one.split()[0]) for one in counted) == len(outcomes)
    write(every_word)
    reader, _ = read(every_word)
    chips = reader.text.split("contradicts", 1)[0]
    assert f"1○ {not_reproduced} (none holds in most settings)" in chips
    assert f"1○ {falls_short}" in chips


def test_a_picture_keeps_its_pixels_in_fewer_bytes(every_word):
    (picture,) = next(row for row in every_word.entries if row.pictures).pictures
    address = html.embedded(picture)
    held = base64.b64decode(address.removeprefix("data:image/png;base64,"))
    assert len(held) < picture.stat().st_size / 2
    with Image.open(io.BytesIO(held)) as small, Image.open(picture) as whole:
        assert small.size == whole.size
        away = ImageChops.difference(small.convert("RGB"), whole.convert("RGB"))
        assert max(high for _, high in away.getextrema()) < 16  # of 255


def test_a_picture_of_two_columns_is_shown_over_the_whole_page(every_word):
    (picture,) = next(row for row in every_word.entries if row.pictures).pictures
    write(every_word)
    assert 'class="whole"' not in read(every_word)[1]
    with Image.open(picture) as image:
        image.resize((2127, 600)).save(picture)
    write(every_word)
    assert read(every_word)[1].count('class="whole"') == 1


def test_a_long_table_is_shortened_and_its_file_named(every_word):
    write(every_word)
    reader, text = read(every_word)
    assert "70 lines, the first 20 here, the rest in fig20/fig20.csv" in reader.text
    assert text.count("<td>0.1235</td>") == 20


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        (Plan(Level.QUICK, (1,)), "Indicative: one seed, no intervals"),
        (Plan(Level.QUICK, (1, 2)), "Indicative: no sweeps"),
        (Plan(Level.STANDARD, (4,)), "Indicative: one seed, no intervals"),
        (Plan(), None),
    ],
)
def test_a_page_without_intervals_says_so_at_its_head(every_word, plan, said):
    ledger = replace(every_word, plan=plan)
    write(ledger)
    reader, _ = read(ledger)
    assert (said or "Indicative") in reader.text if said else "Indicative" not in reader.text


def test_a_page_of_some_claims_says_that_it_is_a_part(every_word):
    write(every_word)
    plain = json.loads((every_word.folder / "ledger.json").read_text(encoding="utf-8"))
    n = len(plain["findings"])
    assert n < len(CLAIMS)
    assert f"A part, {n} of the {len(CLAIMS)} claims, of" in read(every_word)[0].text
    whole = {**plain, "findings": [{**plain["findings"][0], "id": one} for one in CLAIMS]}
    assert "Every figure and claim of" in page.render(PAPER, whole, every_word.tables, every_word.folder)


def test_an_empty_ledger_is_a_page_too(every_word):
    empty = replace(every_word, entries=(), problems={}, tables={})
    write(empty)
    read(empty)


def test_a_file_that_cannot_be_written_leaves_the_old_one_whole(every_word, monkeypatch):
    write(every_word)
    before = (every_word.folder / "ledger.html").read_bytes()

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(disk.os, "replace", fail)
    with pytest.raises((OSError, ResultsError)):
        write(replace(every_word, entries=()))
    assert (every_word.folder / "ledger.html").read_bytes() == before


def test_an_open_question_is_answered_by_the_findings_about_it(every_word):
    rows = tuple(
        replace(row, finding=replace(row.finding, also=("half the spin is taken",)))
        if row.id in ("fig20", "eq13")
        else row
        for row in every_word.entries
    )
    write(replace(every_word, entries=rows))
    _, text = read(every_word)
    answer = text[text.index('id="question-rolling-friction"') : text.index('id="claims"')]
    assert "half the spin is taken" in answer
    assert 'href="#eq13"' in answer
    assert 'href="#fig20"' not in answer
    assert "question-water-torque" not in text  # no row answers it


def test_the_page_names_what_the_paper_says_without_a_row(every_word):
    write(every_word)
    _, text = read(every_word)
    listed = text[text.index('id="unjudged"') : text.index('id="terms"')]
    silent = [one for name, one in PAPER.registration.claims.items() if name not in CLAIMS]
    assert len(silent) > 20
    assert all(one.why_not for one in silent)
    assert all(one.translation in html_unescape(listed) for one in silent)
