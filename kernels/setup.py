"""Version and pins of the wheel: those of the manifest that make.py wrote."""

import json
from pathlib import Path

from setuptools import Distribution, setup


class Compiled(Distribution):
    """A distribution for one minor version of Python and one system."""

    def has_ext_modules(self) -> bool:
        """Whether there is machine code."""
        return True


told = json.loads(Path("ryusa_kernels/manifest.json").read_bytes())
made = dict(one.split(" ", 1) for one in told["versions"] if " " in one)
setup(
    distclass=Compiled,
    version=told["ryusa"],
    install_requires=[
        f"ryusa=={told['ryusa']}",
        f"numba=={made['numba']}",
        f"llvmlite=={made['llvmlite']}",
        f"numpy=={made['numpy']}.*",
    ],
)
