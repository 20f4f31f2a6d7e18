"""Arrays of the atoms of one rank, in the memory of LAMMPS."""

import ctypes
from typing import Any

import numpy as np

from ryusa.engine.lammps import commands as C
from ryusa.model.fluid import N_IMPULSE, N_KEPT, N_SAMPLED

_DOUBLE, _INT = np.dtype(np.float64), np.dtype(np.int32)
# type, and number of columns, 0 of a vector
_ARRAYS = {
    "id": (_INT, 0), "image": (_INT, 0), "radius": (_DOUBLE, 0), "rmass": (_DOUBLE, 0),
    **{name: (_DOUBLE, 3) for name in ("x", "v", "omega", "f", "torque")},
    C.SAMPLED: (_DOUBLE, N_SAMPLED), C.IMPULSE: (_DOUBLE, N_IMPULSE), C.LAST: (_DOUBLE, C.N_LAST),
    C.KEPT: (_DOUBLE, N_KEPT),
}  # fmt: skip


class AtomArrays:
    """Arrays by name; what LAMMPS holds, not copies."""

    def __init__(self, lmp: Any) -> None:
        self._lmp = lmp
        self._extract, self._count = lmp.lib["lammps_extract_atom"], lmp.lib["lammps_extract_setting"]
        self._extract.restype, self._extract.argtypes = ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_char_p]
        self._count.restype, self._count.argtypes = ctypes.c_int, [ctypes.c_void_p, ctypes.c_char_p]
        self._known: dict[str, tuple[int, int, np.ndarray]] = {}  # address, number of atoms, array

    def __call__(self, name: str) -> np.ndarray:
        """An array of the atoms of this rank; LAMMPS moves it when it grows."""
        kind, columns = _ARRAYS[name]
        n = self._count(self._lmp.lmp, b"nlocal")
        where = self._extract(self._lmp.lmp, name.encode())
        if n == 0 or not where:
            return np.zeros((0, columns) if columns else 0, kind)
        if columns:  # rows are contiguous: the first pointer is that of all
            where = int(ctypes.c_void_p.from_address(where).value or 0)
        known = self._known.get(name)
        if known is None or known[0] != where or known[1] != n:
            size = n * max(columns, 1)
            flat = np.ctypeslib.as_array((np.ctypeslib.as_ctypes_type(kind) * size).from_address(where))
            known = self._known[name] = (where, n, flat.reshape(n, columns) if columns else flat)
        return known[2]
