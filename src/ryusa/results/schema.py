"""Names of files, datasets and columns in a run folder, shared by the recorder and the reader."""

import re
from pathlib import Path

import numpy as np

from ryusa.model import Tally, Term
from ryusa.model.tally import HELD

FORMAT = 2  # raised, with the major version of ryusa, when an older reader could misread a folder
READ_BY = "ryusa 1.x"  # versions that read this format, as provenance.json tells
FOREIGN = "another version of ryusa wrote it, or it is damaged"  # of a part with other datasets or columns

CASE_TOML = "case.toml"  # the case as read, byte for byte
START = "start.csv"  # grains of another run, where the case starts from its frame
REACH = "reach.json"  # what a river takes from its feeder reach
SIEVE = "sieve.csv"  # sieve curve of the grains, where the case names a file
CASE_JSON = "case.json"  # the same, resolved, in SI
PROVENANCE = "provenance.json"
SUMMARY = "summary.json"
LOG = "log.txt"
GRAINS = "grains.vtkhdf"  # the file to open in ParaView
BED = "bed.vtkhdf"
REPORT = "report.html"  # what ran and what it found, written by `ryusa report`
BRIEF = "brief.html"  # one sheet about it for a client, written by `ryusa report --brief`
VIEW = "view.html"  # the grains in motion, written by `ryusa view`
FILM = "film.webp"  # the same as a film, written by `ryusa film`
PICTURES = "pictures"  # folder of what `ryusa draw` wrote
CHECKPOINT = "checkpoint.h5"  # for resuming, and for lengthening a complete run
CHECKPOINT_BEFORE = "checkpoint-before.h5"  # the previous one
LOCK = ".lock"  # held by the process that writes
PARTS = "parts"  # folder of write-once HDF5 files

PART_NAME = re.compile(r"part-(\d{6})\.h5")
SCENE_NAME = re.compile(r"scene-(\d{6})\.h5")
SUBINDEX_NAME = re.compile(r"subindex-(\d{6})-\d+-\d+\.h5")  # over some parts

# status in provenance.json
RUNNING, COMPLETE, STOPPED, FAILED = "running", "complete", "stopped", "failed"
INTERRUPTED = "interrupted"  # by a second Ctrl-C: at once, without a checkpoint of that step

# attributes of a part
END_STEP = "end_step"  # contacts that ended up to this step are in this part or an earlier one
TAIL = "tail"  # 1 if contacts of an incomplete part follow; the next part replaces them

# datasets of a part: k frames of n grains
FRAME_DATASETS = {
    "t": (np.dtype(np.float64), ()),  # [s], shape (k,)
    "step": (np.dtype(np.int64), ()),
    "x": (np.dtype(np.float64), (3,)),  # [m], as the engine holds it (wrapped), shape (k, n, 3)
    "v": (np.dtype(np.float64), (3,)),  # [m/s]
    "omega": (np.dtype(np.float64), (3,)),  # [rad/s]
    "image": (np.dtype(np.int32), (2,)),  # periods crossed in x and y
}
# In the group GROUP of `scene.flow`, if water moves in the run: k frames of its `fields`, with their unit and
# axes as attributes.

# impulses on walls and their work since the start, if the run has walls: (k, n_wall, model.walls.N_IMPULSE)
WALLS = "walls"
# way of each wall along the direction of its servo, if the run has one: (k, n_wall) [m]
TRAVEL = "wall_travel"

# motion of clumps, if the run has some, as model.BodyState: k frames of n_body
BODY_DATASETS = {
    "bodies/x": (np.dtype(np.float64), (3,)),
    "bodies/v": (np.dtype(np.float64), (3,)),
    "bodies/q": (np.dtype(np.float64), (4,)),
    "bodies/momentum": (np.dtype(np.float64), (3,)),
    "bodies/image": (np.dtype(np.int32), (2,)),
}

# contact forces, if the case records them: those of all frames in one dataset, and the number of each frame
FORCES, N_FORCE = "forces", "n_force"
FORCE = np.dtype(
    [
        ("i", np.int64),  # id of the free grain
        ("j", np.int64),  # id of its partner: free grain, fixed grain or plane (Scene)
        ("force", np.float64, (3,)),  # on grain i [N]
    ]
)

PASSAGES = "passages"  # grains that entered and left, dtype model.PASSAGE, if the case has feeds or exits

PER_GRAIN = ("x", "v", "omega", "image")

_INTEGER = {"overlap_grain", "overlap_step", "n_contact"}
_NOW = ("t", *HELD)
_EXTREME = ("overlap_max", "overlap_grain", "overlap_step", "speed_max", "spin_max", "n_contact")
_CHECK = ("imbalance", "residual")
# one row per frame: terms of Tally, then those of Term in lower case, then imbalance and residual
TALLY = np.dtype(
    [
        (name, np.int64 if name in _INTEGER else np.float64)
        for name in (*_NOW, *_EXTREME, *(term.name.lower() for term in Term), *_CHECK)
    ]
)


def part_name(k: int) -> str:
    """File name of part k."""
    return f"part-{k:06d}.h5"


def subindex_name(first: int, n_frame: int, n_contact: int) -> str:
    """File name of the sub-index that begins with part `first`, unique by its frames and contacts."""
    return f"subindex-{first:06d}-{n_frame}-{n_contact}.h5"


def scene_name(k: int) -> str:
    """File name of scene k: 0 at the start, one more after each change of the timeline."""
    return f"scene-{k:06d}.h5"


def tally_row(tally: Tally) -> tuple[float, ...]:
    """One row of dtype TALLY; energies in J."""
    now = tuple(getattr(tally, name) for name in (*_NOW, *_EXTREME))
    return (*now, *tally.terms, tally.imbalance, tally.residual)


def is_run_folder(folder: Path) -> bool:
    """Whether `folder` is a run folder of ryusa; links are not followed."""
    parts = folder / PARTS
    return (folder / PROVENANCE).is_file() and parts.is_dir() and not parts.is_symlink()
