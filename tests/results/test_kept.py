"""Run folders of earlier versions are read: one is kept of each, and no file of them is ever changed."""

from pathlib import Path

import numpy as np
import pytest

from ryusa.results import Results
from ryusa.running.inspection import inspection

KEPT = sorted(path for path in Path(__file__).with_name("kept").iterdir() if path.is_dir())


@pytest.mark.parametrize("folder", KEPT, ids=lambda folder: folder.name)
def test_a_run_of_an_earlier_version_is_read(folder: Path) -> None:
    run = Results.open(folder)
    assert str(run.provenance["ryusa"]).startswith(folder.name)
    assert run.complete
    assert run.frames.x[:].shape == (len(run.frames), run.scene.n_grain, 3)
    assert np.isfinite(run.frames.v[-1]).all() and len(run.tally["t"]) == len(run.frames) > 1
    assert len(run.contacts) > 0
    assert f"ryusa {folder.name}" in "\n".join(inspection(folder))
