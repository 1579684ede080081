"""How kernels are compiled: one decorator, one set of options, one cache that is never stale.

The compiled code is cached on disk. Numba does not notice when a function in another file has changed (numba issue 1833), so the cache
folder of a room carries a hash of all its sources and of the versions of the compiler.

What a kernel computes is chosen by the types of its arguments. Each effect or law has its parameters in a NamedTuple of floats, an absent
effect is None, and `specialised` picks the code by that type, so the signature of a kernel *is* the scene and an absent effect leaves no
instruction.
"""

import hashlib
import os
import tempfile
import warnings
from functools import cache
from pathlib import Path

import numba
import numpy as np
from llvmlite import __version__ as llvmlite_version
from numba import njit, types
from numba.extending import overload
from platformdirs import user_cache_dir

# "contract" fuses multiply and add; the full fastmath would also let the compiler assume that NaN does not exist, and hide a blow-up.
OPTIONS = {"error_model": "numpy", "fastmath": {"contract"}}
PACKAGE = Path(__file__).parent


@cache
def cache_folder(room):
    """The folder of the compiled kernels of a room: below NUMBA_CACHE_DIR if that is set, else below the user's cache folder."""
    sources = [Path(__file__), *sorted((PACKAGE / room).rglob("*.py"))]
    versions = f"{numba.__version__} {llvmlite_version} {np.__version__}"
    digest = hashlib.sha256(versions.encode() + b"".join(source.read_bytes() for source in sources)).hexdigest()[:16]
    base = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(base) / "anisogran" if base else Path(user_cache_dir("anisogran", appauthor=False))
    return str(folder / f"{room}-{digest}")


@cache
def cache_is_usable(room):
    """Whether the cache folder is ours and can be written; if not, warns once that every process will compile anew.

    Numba would then fall back to a folder that knows nothing of the sources of other files, and run stale kernels. What lies in the folder
    is unpickled and run, so it is made for its owner alone, and one of another user is left alone.
    """
    folder = Path(cache_folder(room))
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            ours = not hasattr(os, "getuid") or folder.stat().st_uid == os.getuid()
        trouble = "" if ours else "belongs to another user"
    except OSError as error:
        trouble = f"cannot be written ({error.strerror})"
    if trouble:
        warnings.warn(f"{folder} {trouble}: kernels are compiled anew in every process", stacklevel=2)
    return not trouble


def kernel(function, **options):
    """The function, compiled at its first call and cached on disk for the next process."""
    options = {**OPTIONS, "no_cfunc_wrapper": True, **options}
    room = Path(function.__code__.co_filename).relative_to(PACKAGE).parts[0]
    if not cache_is_usable(room):
        return njit(**options)(function)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder(room)  # read by Numba while it decorates; the user's own kernels keep their setting
    try:
        return njit(cache=True, **options)(function)
    finally:
        numba.config.CACHE_DIR = before


def subkernel(function):
    """A function that only other kernels call: without the way in from Python it compiles in two thirds of the time."""
    return kernel(function, no_cpython_wrapper=True)


def specialised(table):
    """A function of (effect, ...) that stands for table[type(effect)], chosen by the compiler or, without one, at the call."""

    def call(effect, *arguments):
        return table[type(effect)](effect, *arguments)

    @overload(call, jit_options=OPTIONS, strict=False)
    def _compiled(effect, *arguments):
        return table[type(None) if effect == types.none else effect.instance_class]

    return call
