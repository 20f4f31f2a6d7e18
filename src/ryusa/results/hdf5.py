"""HDF5 files that may be damaged or manipulated: only plain datasets are read, with their sizes checked."""

from collections import OrderedDict
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from ryusa.errors import ResultsError

# errors that h5py raises on a damaged file
DAMAGE = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)


def open_file(path: Path) -> h5py.File:
    """Open an HDF5 file of a run folder for reading.

    Raises
    ------
    ResultsError : the file is missing, is a link, or is not HDF5.
    """
    if path.is_symlink() or not path.is_file():
        raise ResultsError(f"{path}: no such file in the run folder (links are not followed)")
    try:
        return h5py.File(path, "r", locking=False)
    except DAMAGE as error:
        raise ResultsError(f"{path}: not a readable HDF5 file ({error})") from error


@contextmanager
def opened(path: Path) -> Generator[h5py.File]:
    """Open a file as `open_file` does, and close it at the end of the block."""
    with open_file(path) as file:
        try:
            yield file
        except DAMAGE as error:
            raise ResultsError(f"{path}: damaged ({error})") from error


class OpenFiles:
    """The HDF5 files read most recently, kept open with their checked datasets."""

    def __init__(self, most: int = 8) -> None:
        self._most = most
        self._files: OrderedDict[Path, tuple[h5py.File, dict[str, h5py.Dataset]]] = OrderedDict()

    def dataset(self, path: Path, name: str) -> h5py.Dataset:
        """Return a plain dataset, checked at its first use."""
        if path not in self._files:
            self._files[path] = (open_file(path), {})
            while len(self._files) > self._most:
                self._files.popitem(last=False)[1][0].close()
        self._files.move_to_end(path)
        file, datasets = self._files[path]
        if name not in datasets:
            datasets[name] = plain_dataset(file, name, path)
        return datasets[name]


def plain_dataset(file: h5py.File, name: str, path: Path) -> h5py.Dataset:
    """Return a dataset after checking that its data are in this file and have the size of its shape.

    Raises
    ------
    ResultsError : it is missing, refers to another file, or its stored size does not match its shape.
    """
    link = file.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink):
        raise ResultsError(f"{path}: has no dataset '{name}' of its own")
    dataset = file[name]
    if (
        not isinstance(dataset, h5py.Dataset)
        or dataset.is_virtual
        or dataset.external
        or dataset.shape is None
    ):
        raise ResultsError(f"{path}: '{name}' is not a plain dataset")
    if dataset.dtype.hasobject:
        raise ResultsError(f"{path}: '{name}' holds objects, not numbers")
    nbytes = dataset.dtype.itemsize
    for length in dataset.shape:
        nbytes *= length
    if dataset.id.get_storage_size() != nbytes:
        raise ResultsError(
            f"{path}: '{name}' claims {nbytes} bytes but {dataset.id.get_storage_size()} are stored"
        )
    return dataset


def read_dataset(file: h5py.File, name: str, path: Path) -> np.ndarray:
    """Read a whole plain dataset."""
    return plain_dataset(file, name, path)[()]


def read_integer(file: h5py.File, name: str, path: Path) -> int:
    """Read an integer attribute of the file."""
    if name not in file.attrs:
        raise ResultsError(f"{path}: has no '{name}'")
    kept = file.attrs.get_id(name)
    if kept.shape != () or kept.dtype.kind not in "iu":
        raise ResultsError(f"{path}: its '{name}' is not an integer")
    return int(np.asarray(file.attrs[name]))
