"""ryusa (流砂): every grain of sand, gravel or debris in moving water, by the distinct element method.

>>> import ryusa
>>> case = ryusa.load("case.toml")  # doctest: +SKIP
>>> run = ryusa.run(case)  # doctest: +SKIP
>>> run.frames.x[-1], run.contacts["overlap_max"]  # doctest: +SKIP
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ryusa import measure
    from ryusa.campaigns.calibrate import calibrate
    from ryusa.campaigns.soften import soften
    from ryusa.campaigns.sweep import sweep
    from ryusa.casefile.case import Case
    from ryusa.casefile.read import read as load
    from ryusa.model import Scene, State
    from ryusa.results import Results
    from ryusa.running.runner import run, run_scene

from ryusa.version import __version__

# name -> (module, name there); "" for the module itself. Loaded when first asked for.
_LAZY = {
    "Case": ("ryusa.casefile.case", "Case"),
    "Results": ("ryusa.results", "Results"),
    "Scene": ("ryusa.model", "Scene"),
    "State": ("ryusa.model", "State"),
    "calibrate": ("ryusa.campaigns.calibrate", "calibrate"),
    "load": ("ryusa.casefile.read", "read"),
    "measure": ("ryusa.measure", ""),
    "run": ("ryusa.running.runner", "run"),
    "run_scene": ("ryusa.running.runner", "run_scene"),
    "soften": ("ryusa.campaigns.soften", "soften"),
    "sweep": ("ryusa.campaigns.sweep", "sweep"),
}

__all__ = [
    "Case",
    "Results",
    "Scene",
    "State",
    "__version__",
    "calibrate",
    "load",
    "measure",
    "run",
    "run_scene",
    "soften",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'ryusa' has no attribute '{name}'")
    module, inside = _LAZY[name]
    found = import_module(module)
    return getattr(found, inside) if inside else found


def __dir__() -> list[str]:
    return sorted(__all__)
