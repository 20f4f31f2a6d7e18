"""Whether a CUDA device can be used here; asked before numba-cuda is loaded."""

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
    return "" if cards else "the CUDA driver finds no card"


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
