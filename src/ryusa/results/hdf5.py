"""HDF5 files that may have been tampered with: plain datasets only, sizes checked against the disk."""

from collections import OrderedDict
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from ryusa.errors import ResultsError

# what h5py makes of a file with wrong bytes in it
DAMAGE = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)


def open_file(path: Path) -> h5py.File:
    """An HDF5 file of a run folder, open for reading.

    Raises
    ------
    ResultsError : missing, a link to somewhere else, or not HDF5.
    """
    if path.is_symlink() or not path.is_file():
        raise ResultsError(f"{path}: no such file in the run folder (links are not followed)")
    try:
        return h5py.File(path, "r", locking=False)
    except DAMAGE as error:
        raise ResultsError(f"{path}: not a readable HDF5 file ({error})") from error


@contextmanager
def opened(path: Path) -> Generator[h5py.File]:
    """As `open_file`, closed at the end of the block."""
    with open_file(path) as file:
        try:
            yield file
        except DAMAGE as error:
            raise ResultsError(f"{path}: damaged ({error})") from error


class OpenFiles:
    """The few HDF5 files last read from, kept open with their checked datasets."""

    def __init__(self, most: int = 8) -> None:
        self._most = most
        self._files: OrderedDict[Path, tuple[h5py.File, dict[str, h5py.Dataset]]] = OrderedDict()

    def dataset(self, path: Path, name: str) -> h5py.Dataset:
        """A plain dataset, checked when first asked for."""
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
    """A dataset whose bytes lie in this very file, as many as its shape says.

    Raises
    ------
    ResultsError : missing, or it points outside the file, or its size is not what the file holds.
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
    """The whole of a plain dataset."""
    return plain_dataset(file, name, path)[()]


def read_integer(file: h5py.File, name: str, path: Path) -> int | None:
    """A whole number kept as an attribute of the file; None where there is none."""
    if name not in file.attrs:
        return None
    kept = file.attrs.get_id(name)
    if kept.shape != () or kept.dtype.kind not in "iu":
        raise ResultsError(f"{path}: its '{name}' is no whole number")
    return int(np.asarray(file.attrs[name]))
