"""Rows of `ryusa check` about laws: what each word of the case chooses, and its source."""

from ryusa.casefile.case import Case
from ryusa.casefile.choices import in_force, section_of
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.rows import ExplainRow, word
from ryusa.casefile.section import given


def law_rows(case: Case) -> list[ExplainRow]:
    """One row for each family of laws that has an effect in the case."""
    rows: list[ExplainRow] = []
    for family, choice in in_force(case).items():
        if water_alone(case) and not family.key.startswith(("water.profile", "water.column", "water.row")):
            continue  # of grains
        section = section_of(case, family)
        stated = section is not None and given(section, family.key.rsplit(".", 1)[1])
        source = f"; {choice.source}" if choice.source else ""
        default = "" if stated else f" ({family.key} not given)"
        rows.append(word("laws", family.key, choice.word, f"{choice.about}{source}{default}"))
    return rows
