"""The compiled kernel behind ctypes."""

from __future__ import annotations

import ctypes
import platform
import sys
import sysconfig
from pathlib import Path

import numpy as np

from roundelay.topology.kernel.reduction import (
    F32,
    F64,
    I32,
    I64,
    LARGEST_VALUE,
    U64,
    Columns,
    Reduction,
    bit_labels,
)

__all__ = ["Compiled"]

_INT, _DOUBLE, _FLOAT, _POINTER = ctypes.c_int64, ctypes.c_double, ctypes.c_float, ctypes.c_void_p

_FOLDER = Path(__file__).parent
_SUFFIXES = {".so", ".dll", ".dylib"}
_INTERFACE = 2
"""The number of the interface, as kernel.h has it."""
_SIGNATURES = {
    "interface": (ctypes.c_int32, ()),
    "distances": (None, (_POINTER, _INT, _POINTER, _INT, _INT, ctypes.c_int, _POINTER)),
    "rips_run": (
        _POINTER,
        (_POINTER, _INT, _POINTER, _FLOAT, ctypes.c_uint32, _INT, _POINTER, _POINTER),
    ),
    "rips_free": (None, (_POINTER,)),
    "rips_sizes": (None, (_POINTER,) * 2),
    "rips_bars": (None, (_POINTER,) * 5),
    "rips_columns": (None, (_POINTER, ctypes.c_int, *(_POINTER,) * 4)),
    "propagate": (
        ctypes.c_int,
        (_POINTER, _INT, _POINTER, _INT, _POINTER, _POINTER, _INT, ctypes.c_int32, _POINTER),
    ),
    "harmonic": (_DOUBLE, (_POINTER, _POINTER, _INT, _INT, _INT, _DOUBLE, _INT, _POINTER)),
}


def _load() -> ctypes.CDLL:
    found = _binary()
    library = ctypes.CDLL(str(found))
    number = _interface(library)
    if number != _INTERFACE:
        told = f"a kernel with interface {_INTERFACE}, found {number} in {found}"
        raise OSError(f"expected {told}; install roundelay again")
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(library, f"roundelay_{name}")
        function.restype, function.argtypes = result, arguments
    return library


def _binary() -> Path:
    """Return the one binary of this build, or of many, as Blender has them, that which fits."""
    for name in ("_kernel", f"_kernel-{_system()}"):
        found = sorted(path for path in _FOLDER.glob(f"{name}.*") if path.suffix in _SUFFIXES)
        if found:
            return found[0]
    raise FileNotFoundError(f"no binary for {_system()} in {_FOLDER}")


def _system() -> str:
    """Name the system that Python was built for, such as linux-x86_64 or macosx-arm64."""
    if sys.platform == "darwin":
        return f"macosx-{platform.machine()}"
    return sysconfig.get_platform()


def _interface(library: ctypes.CDLL) -> int:
    """Return the number of a binary's interface; 1 for those from before it had one."""
    try:
        return int(library.roundelay_interface())
    except AttributeError:
        return 1


def _padded(x: F32) -> F32:
    """Return rows of a length that is a multiple of the kernel's 16 lanes."""
    lacking = -x.shape[1] % 16
    return np.ascontiguousarray(np.pad(x, ((0, 0), (0, lacking))) if lacking else x, np.float32)


class Compiled:
    """The shared library; see :class:`roundelay.topology.kernel.Engine`.

    Raises
    ------
    OSError
        If the binary is missing or cannot be loaded.
    """

    def __init__(self) -> None:
        self._library = _load()

    def distances(self, x: F32, y: F32 | None = None) -> F32:
        """Euclidean distances between rows."""
        left = _padded(x)
        right = left if y is None else _padded(y)
        (m, d), n = left.shape, len(right)
        out = np.zeros((m, n), np.float32)
        self._library.roundelay_distances(
            left.ctypes.data, m, right.ctypes.data, n, d, y is None, out.ctypes.data
        )
        return out

    def reduce(self, lengths: F32, *, limit: float, prime: int, longest: int) -> Reduction:
        """Run the filtration."""
        n = len(lengths)
        keys = np.empty(n * (n - 1) // 2, np.uint64)
        fill = np.empty((n, n), np.uint16)
        labels = bit_labels(n)
        state = self._library.roundelay_rips_run(
            lengths.ctypes.data, n, labels.ctypes.data, limit, prime, longest,
            keys.ctypes.data, fill.ctypes.data,
        )  # fmt: skip
        if not state:
            raise MemoryError("out of memory while reducing the filtration")
        try:
            return self._read(state, keys, fill)
        finally:
            self._library.roundelay_rips_free(state)

    def _read(self, state: int, keys: np.ndarray, fill: np.ndarray) -> Reduction:
        sizes = np.empty(8, np.int64)
        self._library.roundelay_rips_sizes(state, sizes.ctypes.data)
        processed, merged, born, *shapes, out_of_range = sizes.tolist()
        if out_of_range:
            raise OverflowError("coefficients of a relation leave the range of 64 bits")
        merges, births = np.empty(merged, np.float32), np.empty(born, np.uint64)
        deaths, killer = np.empty(born, np.float32), np.empty(born, np.int64)
        self._library.roundelay_rips_bars(
            state, *(array.ctypes.data for array in (merges, births, deaths, killer))
        )
        relations, reduced = (
            self._columns(state, which, shapes[2 * which], shapes[2 * which + 1])
            for which in (0, 1)
        )
        return Reduction(keys[:processed], fill, merges, births, deaths, killer, relations, reduced)

    def _columns(self, state: int, reduced: int, count: int, entries: int) -> Columns:
        columns = Columns(
            np.empty(count + 1, np.int64),
            np.empty(entries, np.int32),
            np.empty(entries, np.int64),
            np.empty(count, np.float32),
        )
        arrays = (columns.start, columns.index, columns.value, columns.time)
        self._library.roundelay_rips_columns(
            state, reduced, *(array.ctypes.data for array in arrays)
        )
        return columns

    def propagate(self, reduced: Reduction, count: int, on_births: I64, modulus: int) -> I32:
        """Extend a cocycle from the births to the first edges."""
        n = len(reduced.fill)
        values = np.empty(count, np.int32)
        if not modulus and abs(on_births).max(initial=0) > LARGEST_VALUE:
            raise OverflowError("values of the cocycle leave the range of 15 bits")
        given = np.ascontiguousarray(on_births, np.int32)
        done = self._library.roundelay_propagate(
            reduced.keys.ctypes.data, count, reduced.fill.ctypes.data, n,
            reduced.births.ctypes.data, given.ctypes.data, len(given), modulus,
            values.ctypes.data,
        )  # fmt: skip
        if done < 0:
            raise MemoryError("out of memory while extending a cocycle")
        if not done:
            raise OverflowError("values of the cocycle leave the range of 15 bits")
        return values

    def harmonic(
        self, keys: U64, values: I32, start: F64, *, close: int, tolerance: float
    ) -> tuple[F64, float]:
        """Minimise the weighted norm of values + dw."""
        w = start.copy()
        largest = self._library.roundelay_harmonic(
            keys.ctypes.data, values.ctypes.data, len(keys), len(w), close, tolerance,
            4 * len(w), w.ctypes.data,
        )  # fmt: skip
        if largest < 0:
            raise MemoryError("out of memory while smoothing a cocycle")
        return w, largest
