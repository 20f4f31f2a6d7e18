"""The tables of a calibration in texts, for its page and for a terminal; angles in degrees."""

import math
from collections.abc import Mapping, Sequence
from functools import partial

from ryusa.campaigns.calibrate.coverage import Coverage
from ryusa.campaigns.calibrate.execution import Calibration, Predicted
from ryusa.campaigns.calibrate.sentences import move_words, shown
from ryusa.campaigns.calibrate.tables import printed_interval, printed_number
from ryusa.campaigns.sweep.pictures import printed_unit
from ryusa.study.printed_table import PrintedCell, PrintedTable

_WORDS = frozenset({"observation", "quantity", "parameter", "unit", "verdict", "prior", "", "observations"})
_TO_GIVE = "to give the observation"


def observations_table(made: Calibration) -> PrintedTable:
    """Every observation beside the posterior and all runs."""
    rows: list[Sequence[str | PrintedCell]] = []
    for asked, one, si in zip(
        made.asked.observations, made.verdict.compared, made.observed_units, strict=True
    ):
        unit, factor = shown(si)
        seen = f"{factor * one.value:.4g} ± {factor * one.error:.2g}"
        misfit = f"{one.misfit:+.1f}"
        rows.append(
            (
                asked.words, printed_unit(unit),
                f"{seen} ± {factor * one.discrepancy:.2g}" if one.discrepancy else seen,
                printed_number(one.predicted, 4, factor), printed_interval(one.least, one.most, factor),
                misfit if one.reached else PrintedCell(misfit, "partly"),
                move_words(one.move, made.asked.priors),
            )
        )  # fmt: skip
    heads = (
        "observation", "unit", "observed ± s.e.", "posterior", "all runs", "misfit, in s.d.", _TO_GIVE,
    )  # fmt: skip
    return PrintedTable(heads, rows, _WORDS | {_TO_GIVE})


def parameters_table(made: Calibration, *, brief: bool = False) -> PrintedTable:
    """Every parameter with its verdict, yes or no if `brief`, and what of its posterior may be given."""
    verdict = "determined" if brief else "verdict"
    heads = (
        "parameter", verdict, "prior", "mean", "s.d.", "unit", "68 %", "95 %", "s.d. over prior's",
    )  # fmt: skip
    rows = [
        (
            str(row["parameter"]), _verdict(row, brief),
            str(row["prior"]), printed_number(row["mean"], 4), printed_number(row["standard_deviation"], 2),
            "" if row["unit"] == "-" else str(row["unit"]), printed_interval(row["low_68"], row["high_68"]),
            printed_interval(row["low_95"], row["high_95"]), printed_number(row["over_prior"], 2),
        )
        for row in made.rows
    ]  # fmt: skip
    return PrintedTable(heads, rows, _WORDS)


def _verdict(row: Mapping[str, object], brief: bool) -> PrintedCell:
    if brief:
        return PrintedCell("yes" if row["determined"] else "no")
    return PrintedCell(str(row["verdict"]), "" if row["determined"] else "no bold")


def correlation_table(made: Calibration) -> PrintedTable:
    """Correlation of the parameters in the posterior."""
    keys = [one.key for one in made.asked.priors]
    rows = [
        (key, *(f"{value:+.2f}" for value in row))
        for key, row in zip(keys, made.posterior.correlation(), strict=True)
    ]
    return PrintedTable(("", *keys), rows, _WORDS)


def quantities_table(made: Calibration, *, predicted: bool = False) -> PrintedTable:
    """Quantities over posterior and prior, those that were observed among them unless `predicted`."""
    heads = ("quantity", "unit", "", "posterior", "s.d.", "95 %", "s.d. of one run", "prior ± s.d.")
    rows = [_quantity(one) for one in made.predicted if one.observed is None or not predicted]
    return PrintedTable(heads, rows, _WORDS)


def _quantity(one: Predicted) -> tuple[str, ...]:
    unit, factor = shown(one.unit)
    number = partial(printed_number, factor=factor)
    return (
        one.target.words, printed_unit(unit), "predicted" if one.observed is None else "observed",
        number(one.mean, 4), number(one.sd, 2), printed_interval(one.low, one.high, factor),
        number(one.run_sd, 2), f"{factor * one.prior_mean:.4g} ± {factor * one.prior_sd:.2g}",
    )  # fmt: skip


def coverage_tables(found: Coverage, keys: tuple[str, ...]) -> tuple[PrintedTable, PrintedTable]:
    """How many intervals hold their made-up truth, and how many verdicts on them are wrong."""
    inside = [
        (
            str(row["parameter"]), str(row["interval"]),
            _judged(f"{row['inside']} of {row['truths']}", row["as_expected"]),
            f"{row['expected_low']} to {row['expected_high']}",
        )
        for row in found.rows(keys)
    ]  # fmt: skip
    wrong = [
        (
            str(row["observations"]),
            _judged(f"{row['wrong']} of {row['of']}", row["as_expected"]),
            str(row["at_most"]),
        )
        for row in found.verdict_rows()
    ]
    of_inside = ("parameter", "interval", "hold the truth", "by chance, with 95 %")
    of_wrong = ("observations", "wrong verdicts", "at most by chance, if 5 % are wrong")
    return PrintedTable(of_inside, inside, _WORDS), PrintedTable(of_wrong, wrong, _WORDS)


def _judged(text: str, expected: object) -> PrintedCell:
    return PrintedCell(text, "yes" if expected else "no")


def emulators_table(made: Calibration) -> PrintedTable:
    """How well the emulator of each quantity predicts runs that are left out."""
    heads = (
        "quantity", "unit", "runs", "s.d. of all runs", "s.d. between seeds", "r.m.s. error, left out",
        "within ± s.d. (68 %)",
    )  # fmt: skip
    rows: list[tuple[str, ...]] = []
    for one in made.predicted:
        emulator = made.emulators[one.target]
        away, sd = emulator.left_out()
        unit, factor = shown(one.unit)
        widths = (emulator.scale, emulator.noise, math.sqrt((away**2).mean()))
        inside = 100.0 * float((abs(away) <= sd).mean())
        rows.append(
            (
                one.target.words, printed_unit(unit), str(len(away)),
                *(f"{factor * width:.2g}" for width in widths), f"{inside:.0f} %",
            )
        )  # fmt: skip
    return PrintedTable(heads, rows, _WORDS)
