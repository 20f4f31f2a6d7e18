"""Which stiffness is soft enough for one case and one measure: `ryusa soften`."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ryusa.campaigns.soften.answer import Answer, Question, Softening, SofterError, SofterRuns
from ryusa.campaigns.soften.study import SoftenPart, SoftenStudy
from ryusa.casefile.precision import ErrorLimit, limit_reader
from ryusa.catalogue import MEASURES
from ryusa.errors import CaseError, ResultsError
from ryusa.spelling import nearest_word
from ryusa.study import Plan, ProgressLines, case_run
from ryusa.study.executors import DEFAULT, executor_of
from ryusa.study.ledger import make
from ryusa.study.page import write

__all__ = [
    "Answer",
    "Question",
    "SoftenStudy",
    "Softening",
    "SofterError",
    "SofterRuns",
    "soften",
    "study_of",
]

FACTORS = (4.0, 16.0, 64.0)  # stiffness of the case over those that are run
LARGEST = 1.0e6  # of these factors
AGAINST = ("case", "hard")


def soften(
    case: Path | str,
    measure: str,
    to: str,
    *,
    value: str | None = None,
    seeds: int | Sequence[int] = 3,
    softer: Sequence[float] = FACTORS,
    against: str = "case",
    overrides: Mapping[str, str] | None = None,
    folder: Path | str | None = None,
    jobs: int | None = None,
    on: str = DEFAULT,
    progress: bool = True,
) -> Softening:
    """Find out which stiffness is soft enough for a case and a measure.

    Parameters
    ----------
    case : case file.
    measure : name of a measure, as for `ryusa measure`.
    to : tolerance: a share such as "5 %", or an error in the unit of the number such as "1 deg".
    value : which number of the measure; not needed if it has one.
    seeds : number of seeds for each stiffness, or the seeds; two or more.
    softer : stiffness of the case over those that are run, three or more different numbers from 1 on.
    against : what errors refer to: "case", the stiffness of the case, or "hard", the limit of hard grains.
    overrides : changes to the case, as `ryusa run --set` takes them.
    folder : for page, table, picture and runs; default runs/soften-CASE. Finished runs in it are opened.
    jobs : number of runs at a time; if not given one, or as many as dask has threads.
    on : where runs are carried out: "processes" or "dask:ADDRESS".
    progress : whether to print cost and progress on stderr.

    Raises
    ------
    CaseError : the case cannot be run or softened, or an argument is not allowed.
    ResultsError : a run could not be measured.
    """
    path = Path(case)
    study = study_of(path, measure, to, value=value, softer=softer, against=against, overrides=overrides)
    plan = plan_of_seeds(tuple(range(1, seeds + 1)) if isinstance(seeds, int) else tuple(seeds))
    out = Path("runs") / f"soften-{path.stem}" if folder is None else Path(folder)
    ledger = make(
        study, None, plan, out, where=executor_of(on, jobs), progress=ProgressLines() if progress else None
    )
    write(ledger)
    if study.answer is None:
        raise ResultsError("; ".join(one.problem for one in ledger.entries))
    return study.answer


def study_of(
    case: Path,
    measure: str,
    to: str,
    *,
    value: str | None = None,
    softer: Sequence[float] = FACTORS,
    against: str = "case",
    overrides: Mapping[str, str] | None = None,
) -> SoftenStudy:
    """Return the study that answers; arguments as those of `soften`.

    Raises
    ------
    CaseError : the case cannot be run or softened, or an argument is not allowed.
    """
    if against not in AGAINST:
        raise CaseError(
            "against", against, f"must be one of {', '.join(AGAINST)}", nearest_word(against, AGAINST)
        )
    number, unit = _number(measure, value)
    question = Question(measure, number, unit, _tolerance(to, unit), against == "hard")
    words = f"ryusa soften {case.name} --measure {measure} --value {number} --to '{to}'"
    return SoftenStudy(SoftenPart(case_run(case, overrides), question, _factors(softer)), words)


def plan_of_seeds(seeds: Sequence[int]) -> Plan:
    """Plan with these seeds.

    Raises
    ------
    CaseError : fewer than two.
    """
    if len(set(seeds)) < 2:
        raise CaseError(
            "seeds", len(seeds), "must be two or more: one seed does not show how far numbers scatter"
        )
    return Plan(seeds=tuple(seeds))


def _number(measure: str, value: str | None) -> tuple[str, str]:
    """Name and unit of the number asked for."""
    entries = {one.name: one for one in MEASURES if one.numbers}
    if measure not in entries:
        tables = ", ".join(one.name for one in MEASURES if not one.numbers)
        raise CaseError(
            "measure", measure,
            f"must be one of {', '.join(entries)}; {tables} give no number with a limit for hard grains",
            nearest_word(measure, list(entries)),
        )  # fmt: skip
    numbers = dict(entries[measure].numbers)
    if value is None and len(numbers) > 1:
        raise CaseError("value", None, f"missing; {measure} has {', '.join(numbers)}")
    name = next(iter(numbers)) if value is None else value
    if name not in numbers:
        allowed = f"must be one of {', '.join(numbers)} of {measure}"
        raise CaseError("value", name, allowed, nearest_word(name, list(numbers)))
    return name, numbers[name]


def _tolerance(to: str, unit: str) -> ErrorLimit:
    try:
        found = limit_reader("" if unit == "-" else unit)(to)
    except ValueError as error:
        raise CaseError("to", to, str(error)) from None
    assert found is not None
    return found


def _factors(softer: Sequence[float]) -> tuple[float, ...]:
    if len(set(softer)) < 3 or not all(1.0 <= one <= LARGEST for one in softer):
        allowed = f"must be three or more different factors from 1 to {LARGEST:g}, such as 4,16,64"
        raise CaseError("softer", ",".join(f"{one:g}" for one in softer), allowed)
    return tuple(float(one) for one in dict.fromkeys(softer))
