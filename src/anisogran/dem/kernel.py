"""How the kernels of this room are compiled: one decorator, one switch on the type of an effect, one promise to the vectoriser.

A scene is compiled for exactly the effects it has. Each effect's parameters are a NamedTuple of floats, an absent effect is None, and
`specialised` picks the code by that type, so the signature of a kernel *is* the scene and an absent effect leaves no instruction.

The compiled code is cached on disk. Numba does not notice when a function in another file has changed (numba issue 1833), so the cache
folder carries a hash of all sources of this room and of the versions of the compiler.
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
from llvmlite import ir
from numba import njit, types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic, overload
from platformdirs import user_cache_dir

# "contract" fuses multiply and add; the full fastmath would also let the compiler assume that NaN does not exist, and hide a blow-up.
OPTIONS = {"error_model": "numpy", "fastmath": {"contract"}}


@cache
def cache_folder():
    """The folder of the compiled kernels: below NUMBA_CACHE_DIR if that is set, else below the user's cache folder."""
    sources = sorted(Path(__file__).parent.rglob("*.py"))
    versions = f"{numba.__version__} {llvmlite_version} {np.__version__}"
    digest = hashlib.sha256(versions.encode() + b"".join(source.read_bytes() for source in sources)).hexdigest()[:16]
    base = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(base) / "anisogran" if base else Path(user_cache_dir("anisogran", appauthor=False))
    return str(folder / f"kernels-{digest}")


@cache
def cache_is_writable():
    """Whether the cache folder can be made and written; if not, warns once that every process will compile anew.

    Numba would then fall back to a folder that knows nothing of the sources of other files, and run stale kernels.
    """
    try:
        Path(cache_folder()).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=cache_folder()):
            return True
    except OSError as error:
        warnings.warn(f"{cache_folder()} cannot be written ({error.strerror}): kernels are compiled anew in every process", stacklevel=2)
        return False


def kernel(function, **options):
    """The function, compiled at its first call and cached on disk for the next process."""
    options = {**OPTIONS, "no_cfunc_wrapper": True, **options}
    if not cache_is_writable():
        return njit(**options)(function)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = cache_folder()  # read by Numba while it decorates; the user's own kernels keep their setting
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


@intrinsic
def _restrict(typing_context, array):
    """The same array, returned by a call marked noalias: LLVM may then assume that no other array overlaps it, and vectorises."""

    def generate(context, builder, signature, arguments):
        view = context.make_array(array)(context, builder, value=arguments[0])
        pointer = ir.IntType(8).as_pointer()
        function = builder.module.globals.get("anisogran_restrict")
        if function is None:
            function = ir.Function(builder.module, ir.FunctionType(pointer, [pointer]), "anisogran_restrict")
            function.linkage = "linkonce_odr"
            function.attributes.add("noinline")
            function.return_value.add_attribute("noalias")
            ir.IRBuilder(function.append_basic_block()).ret(function.args[0])
        view.data = builder.bitcast(builder.call(function, [builder.bitcast(view.data, pointer)]), view.data.type)
        return impl_ret_borrowed(context, builder, array, view._getvalue())

    return array(array), generate


def unaliased(array):
    """An array (or None) that a loop writes and that overlaps no other array of the loop. Call it inside the loop's own function."""
    return array


@overload(unaliased, jit_options=OPTIONS)
def _unaliased(array):
    return (lambda array: None) if array == types.none else (lambda array: _restrict(array))


def block(history, begin, end):
    """history[begin:end], or None for the history of an absent effect."""
    return None if history is None else history[begin:end]


@overload(block, jit_options=OPTIONS)
def _block(history, begin, end):
    return (lambda history, begin, end: None) if history == types.none else (lambda history, begin, end: history[begin:end])
