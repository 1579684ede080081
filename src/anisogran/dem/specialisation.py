"""What the kernels of this room need beyond the compiler: memory that absent effects do not have, one promise to the vectoriser."""

from llvmlite import ir
from numba import types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic, overload

from anisogran.compiled import OPTIONS


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
