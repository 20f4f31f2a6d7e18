"""Parameters that observations determine, and those that they do not: `ryusa calibrate`."""

from pathlib import Path

from ryusa.campaigns.calibrate.definition import CalibrationAsked, Observation, Target
from ryusa.campaigns.calibrate.execution import Calibration, Predicted, carry_out_calibration, refuse_truths
from ryusa.campaigns.calibrate.page import write_calibration
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.calibrate.study_file import read_calibration
from ryusa.campaigns.calibrate.verdict import CalibrationVerdict
from ryusa.study import ProgressLines
from ryusa.study.executors import DEFAULT, executor_of

__all__ = [
    "Calibration",
    "CalibrationAsked",
    "CalibrationVerdict",
    "Observation",
    "Predicted",
    "Prior",
    "Target",
    "calibrate",
    "carry_out_calibration",
    "read_calibration",
    "refuse_truths",
    "write_calibration",
]


def calibrate(
    study: Path | str | CalibrationAsked,
    *,
    folder: Path | str | None = None,
    extend: int = 0,
    coverage: int = 0,
    jobs: int | None = None,
    on: str = DEFAULT,
    again: bool = False,
    progress: bool = True,
) -> Calibration:
    """Find the parameters of cases that agree with observations, or say that none do.

    Parameters
    ----------
    study : TOML file with parameters and observations; or the same as `CalibrationAsked`.
    folder : for table, page, pictures and runs; default runs/calibration-STUDY. Finished runs in it are
        opened, and interrupted ones go on.
    extend : how many times priors may be extended where a posterior lies at their edge; 0 for never.
    coverage : number of made-up truths on which intervals and verdict are checked; 0 for none.
    jobs : number of runs at a time; if not given one, or as many as dask has threads.
    on : where runs are carried out: "processes" or "dask:ADDRESS".
    again : make all runs anew.
    progress : whether to print cost and progress on stderr.

    Raises
    ------
    CaseError : a case cannot be run, or the study asks for what is not there; little or nothing was run.
    ResultsError : scikit-learn is missing, the folder holds something else, or too few runs gave a quantity.

    Notes
    -----
    `verdict` of what is returned says whether the model reaches the observations, and `words` says it in
    sentences. Where it does not, `rows` has no values, and no parameter is determined.
    """
    asked = study if isinstance(study, CalibrationAsked) else read_calibration(Path(study))
    refuse_truths(coverage)
    out = Path("runs") / f"calibration-{asked.name}" if folder is None else Path(folder)
    made = carry_out_calibration(
        asked, out, executor_of(on, jobs), again=again, extend=extend, truths=coverage,
        progress=ProgressLines() if progress else None,
    )  # fmt: skip
    write_calibration(made, "ryusa.calibrate")
    return made
