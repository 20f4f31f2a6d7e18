"""Whether a CUDA device can be used here; asked before numba-cuda is loaded."""

from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

_PACKAGE = "the package numba-cuda is not installed: pip install 'ryusa[cuda]'"


def unavailable() -> str:
    """Why no CUDA device can be used here, in one line; nothing when one can."""
    if find_spec("numba_cuda") is None:
        return _PACKAGE
    from numba import cuda

    if simulated():
        return ""
    from numba.cuda.cudadrv.error import CudaSupportError

    try:
        cards = list(cuda.gpus)
    except CudaSupportError as error:
        lines = [line.strip() for line in str(error).splitlines()]
        said = [line for line in lines if line and not line.endswith((":", "init"))]
        return f"no CUDA driver answers: {said[0].rstrip('.') if said else error}"
    return _unfit() if cards else "the CUDA driver finds no card"


def _unfit() -> str:
    """Why numba-cuda cannot compile with the NumPy that is here; nothing when it can."""
    try:
        import_module("numba.cuda.cudaimpl")  # what kernels are compiled from
    except AttributeError as error:
        mine, theirs = version("numba-cuda"), version("numpy")
        return f"numba-cuda {mine} does not go with numpy {theirs} ({error}): pip install 'numpy<2.5'"
    return ""


def device_name() -> str:
    """Name of the card that would be used; only where `absent` finds nothing."""
    from numba import cuda

    if simulated():
        return "numba's CUDA simulator"
    name: Any = cuda.get_current_device().name
    return name.decode() if isinstance(name, bytes) else str(name)


def simulated() -> bool:
    """Whether numba's simulator stands for the card (NUMBA_ENABLE_CUDASIM=1)."""
    from numba import config

    settings: Any = config
    return bool(settings.ENABLE_CUDASIM)
