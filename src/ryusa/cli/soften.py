"""`ryusa soften`: which stiffness is soft enough for a case and a measure."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.catalogue import MEASURES
from ryusa.cli.many_runs import (
    DEFAULT,
    FAILED,
    Again,
    Jobs,
    Json,
    On,
    Show,
    carried_out,
    console,
    executor_at,
    finish,
    list_runs,
    plan_of,
    print_table,
)
from ryusa.cli.options import Quiet
from ryusa.cli.run import CaseFile, Settings, overrides_of
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.campaigns.soften import Softening

Measure = Annotated[
    str,
    typer.Option(
        "--measure", "-m", metavar="NAME", show_default=False,
        help=f"Measure, as for `ryusa measure`: {', '.join(one.name for one in MEASURES if one.numbers)}.",
    ),
]  # fmt: skip
To = Annotated[
    str,
    typer.Option(
        "--to", metavar="TOLERANCE", show_default=False,
        help="Largest error: a share such as '5 %', or in the unit of the number, such as '1 deg'.",
    ),
]  # fmt: skip


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(soften)


def soften(
    case: CaseFile,
    measure: Measure,
    to: To,
    value: Annotated[
        str | None,
        typer.Option("--value", metavar="NAME", help="Number of the measure, if it has several."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", metavar="FOLDER", help="Page, table, picture and runs; default runs/soften-CASE."
        ),
    ] = None,
    softer: Annotated[
        str,
        typer.Option("--softer", metavar="A,B,C,..", help="Stiffness of the case over those that are run."),
    ] = "4,16,64",
    against: Annotated[
        str,
        typer.Option(
            "--against", metavar="case|hard", help="What errors refer to: this case, or hard grains."
        ),
    ] = "case",
    seeds: Annotated[
        str | None,
        typer.Option(
            "--seeds", metavar="N|A,B,..", help="Number of seeds for each stiffness, or the seeds; default 3."
        ),
    ] = None,
    settings: Settings = None,
    json: Json = None,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Show = False,
    quiet: Quiet = False,
) -> None:
    """Find out which stiffness is soft enough to be cheap and still right for a case and a measure.

    Runs softer copies of the case that keep e, k_s/k_n and mu, with several
    seeds each, and extrapolates y_inf + a k^-p to the stiffness of the case
    with an exponent p known only as 1/4 to 1. Prints the error at every
    stiffness and the steps saved, or why it cannot be said (exit code 3).
    Finished runs are opened when the command is given again.
    """
    from ryusa.campaigns.soften import plan_of_seeds, study_of

    plan, where = plan_of_seeds(plan_of(False, False, seeds).seeds), executor_at(on, jobs)
    study = study_of(
        case, measure, to, value=value, softer=_factors(softer), against=against,
        overrides=overrides_of(settings),
    )  # fmt: skip
    out = Path("runs") / f"soften-{case.stem}" if out is None else out
    if show:
        list_runs(study, plan, out, where.jobs, again)
        return
    ledger, files = carried_out(study, None, plan, out, json, where, again, quiet)
    if study.answer is not None:
        _print(study.answer)
    finish(ledger, files, out)
    if study.answer is None or study.answer.answer == "cannot be said":
        raise typer.Exit(FAILED)


def _factors(text: str) -> list[float]:
    try:
        return [float(one) for one in text.split(",")]
    except ValueError:
        raise CaseError("--softer", text, "must be numbers with commas between, such as 4,16,64") from None


def _print(found: "Softening") -> None:
    """Print the error at every stiffness, the steps saved, and the answer."""
    from ryusa.study.interval import short
    from ryusa.study.printed_table import PrintedTable

    question = found.question
    against = "hard grains" if question.against_hard else "the case"
    within = f"within {question.tolerance}"
    heads = (
        "k_n [N/m]", "softer", f"{question.name} [{question.unit}]",
        f"error against {against} [{question.error_unit}]", "steps", "overlap/d", within,
    )  # fmt: skip
    errors = {one.runs.factor: one for one in found.errors}
    words = {True: "yes", False: "no", None: "cannot be said"}
    rows: list[tuple[str, ...]] = []
    for one in found.runs:
        error = errors.get(one.factor)
        cells = ("-", words[None]) if error is None else (question.interval(error.error), words[error.within])
        rows.append(
            (
                short(one.k_n), f"1/{one.factor:g}", short(one.mean), cells[0], f"1/{one.longer:.3g}",
                f"{one.overlap:.2g}", cells[1],
            )
        )  # fmt: skip
    print_table(PrintedTable(heads, rows, frozenset({within})))
    out = console()
    if found.fit is not None and found.fit.follows:
        for what, k_n in (("the stiffness of the case", found.k_n), ("hard grains", float("inf"))):
            out.print(
                f"extrapolated to {what}: {question.number_in_words(found.fit.value(k_n))}", soft_wrap=True
            )
        p = found.fit.exponents
        out.print(f"exponent p: {p.value:.2f} ({p.low:.2f} to {p.high:.2f})")
    for remark in found.remarks:
        out.print(f"warning: {remark}", soft_wrap=True)
    out.print(found.says, soft_wrap=True)
