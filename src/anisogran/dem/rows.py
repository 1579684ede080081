"""One grain is one cache line: a row of eight numbers; and how rows of grains become columns of pairs, and pair forces rows again.

The laws want columns (the x-distance of many pairs, ...) to be vectorised, while memory wants all that is known of a grain in one place:
fetching each quantity by itself, with a gather instruction each, took longer than all the physics. So eight pairs are fetched as sixteen
whole rows, subtracted and added, and transposed in registers. The way back adds the force of a pair to the row of each of its grains.
Both are written in the compiler's vector types, which every processor can do, and in plain Python for runs without the compiler.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from anisogran.compiled import OPTIONS

X, Y, VX, VY, RADIUS, SPIN, INVERSE_MASS, INVERSE_INERTIA = range(8)  # a row of a grain
# the columns of pairs: second minus first, and the sums of both; without anything that asks for more, only the first four are filled
DX, DY, DU, DV, DIFFERENCE_RADIUS, DIFFERENCE_SPIN, SUM_INVERSE_MASS, SUM_SPIN = range(8)
FX, FY, TORQUE = range(3)  # a row of forces has four numbers, the last one is spare
LANES = 8
CACHED = 50_000  # grains; with more of them the rows are in main memory
AHEAD = 64  # pairs: there, rows are asked for that much before they are read


def aligned_zeros(shape, dtype=float):
    """Zeros that begin on a cache line (64 bytes), so that no row and no vector of eight lies across two of them."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    room = np.zeros(size + 64, np.uint8)
    begin = -room.ctypes.data % 64
    return room[begin : begin + size].view(dtype).reshape(shape)


def grain_rows(grains, order):
    """The rows (N, 8) of the grains in that order."""
    rows = aligned_zeros((len(grains), 8))
    rows[:, :2] = grains.position
    rows[:, 2:4] = grains.velocity
    rows[:, RADIUS] = grains.radius
    rows[:, SPIN] = grains.spin
    rows[:, INVERSE_MASS] = 1.0 / grains.mass
    rows[:, INVERSE_INERTIA] = 1.0 / (grains.inertia_factor * grains.mass * grains.radius**2)
    rows[:] = rows[order]
    return rows


_DOUBLE = ir.DoubleType()
_INDEX = ir.IntType(64)


def _pick(*lanes):
    return ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), [ir.Constant(ir.IntType(32), lane) for lane in lanes])


def _load(builder, pointer, size):
    value = builder.load(builder.bitcast(pointer, ir.VectorType(_DOUBLE, size).as_pointer()))
    value.align = 8
    return value


def _store(builder, value, pointer):
    builder.store(value, builder.bitcast(pointer, value.type.as_pointer())).align = 8


def _row(builder, rows, indices, k, width):
    """Pointer to the row of the grain that indices[k] names."""
    grain = builder.zext(builder.load(builder.gep(indices.data, [k])), _INDEX)
    return builder.gep(rows.data, [builder.mul(grain, ir.Constant(_INDEX, width))])


def _column(builder, columns, lane, k):
    """Pointer to entry k of a column."""
    length = builder.extract_value(columns.shape, 1)
    return builder.gep(columns.data, [builder.add(builder.mul(ir.Constant(_INDEX, lane), length), k)])


def _transposed(builder, rows, distances):
    """Vectors of eight lanes, transposed in rounds of exchanges: at 1, 2 and 4 eight rows, at 1 and 2 four rows in each half."""
    for distance in distances:
        low = [lane if not lane & distance else lane - distance + 8 for lane in range(8)]
        high = [lane + distance if not lane & distance else lane + 8 for lane in range(8)]
        exchanged = list(rows)
        for m in range(len(rows)):
            if not m & distance:
                exchanged[m] = builder.shuffle_vector(rows[m], rows[m + distance], _pick(*low))
                exchanged[m + distance] = builder.shuffle_vector(rows[m], rows[m + distance], _pick(*high))
        rows = exchanged
    return rows


@intrinsic
def _ask_for_rows(typing_context, rows, second, begin):
    """Asks for the rows of the second grains of eight pairs, so that they are at hand later, without waiting for them."""

    def generate(context, builder, signature, arguments):
        views = [context.make_array(signature.args[n])(context, builder, value=arguments[n]) for n in (0, 1)]
        byte, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [byte, number, number, number])
        prefetch = builder.module.declare_intrinsic("llvm.prefetch", [byte], kind)
        to_read, keep_near, data = number(0), number(3), number(1)
        for m in range(8):
            row = _row(builder, *views, builder.add(arguments[2], ir.Constant(_INDEX, m)), 8)
            builder.call(prefetch, [builder.bitcast(row, byte), to_read, keep_near, data])
        return context.get_dummy_value()

    return types.void(rows, second, types.int64), generate


def _whole(builder, ends):
    """The eight columns of eight pairs, from both whole rows of each."""
    picked = _pick(0, 1, 2, 3, 4, 5, 8 + INVERSE_MASS, 8 + SPIN)
    vectors = [builder.shuffle_vector(builder.fsub(b, a), builder.fadd(b, a), picked) for a, b in ends]
    return _transposed(builder, vectors, (1, 2, 4))


def _lean(builder, ends):
    """The first four columns of eight pairs, from the first halves of both rows of each."""
    halves = [builder.fsub(b, a) for a, b in ends]
    vectors = [builder.shuffle_vector(halves[m], halves[m + 4], _pick(*range(8))) for m in range(4)]
    return _transposed(builder, vectors, (1, 2))


def _fetching(arrange, width):
    """An intrinsic that fills columns place .. place + 8 for the pairs begin .. begin + 8, from the first `width` numbers of each row."""

    @intrinsic
    def fetch(typing_context, rows, first, second, begin, columns, place):
        def generate(context, builder, signature, arguments):
            views = [context.make_array(signature.args[n])(context, builder, value=arguments[n]) for n in (0, 1, 2, 4)]
            grains, one, other, out = views
            ends = []
            for m in range(8):
                k = builder.add(arguments[3], ir.Constant(_INDEX, m))
                ends.append([_load(builder, _row(builder, grains, indices, k, 8), width) for indices in (one, other)])
            for lane, vector in enumerate(arrange(builder, ends)):
                _store(builder, vector, _column(builder, out, lane, arguments[5]))
            return context.get_dummy_value()

        return types.void(rows, first, second, types.int64, columns, types.int64), generate

    return fetch


_fetch_whole, _fetch_lean = _fetching(_whole, 8), _fetching(_lean, 4)


def _adding(count, width):
    """An intrinsic that adds the forces of `count` neighbouring pairs to the rows of their grains, one pair after the other."""

    @intrinsic
    def add(typing_context, forces, first, second, begin, columns, place):
        def generate(context, builder, signature, arguments):
            views = [context.make_array(signature.args[n])(context, builder, value=arguments[n]) for n in (0, 1, 2, 4)]
            rows, one, other, source = views
            column = [_load(builder, _column(builder, source, lane, arguments[5]), count) for lane in range(width)]
            nothing = ir.Constant(ir.VectorType(_DOUBLE, count), [0.0] * count)
            for m in range(count):
                k = builder.add(arguments[3], ir.Constant(_INDEX, m))
                force = builder.shuffle_vector(column[FX], column[FY], _pick(m, count + m))
                turns = [builder.shuffle_vector(torque, nothing, _pick(m, count + m)) for torque in column[2:]] or [None, None]
                for indices, turn, act in ((one, turns[0], builder.fsub), (other, turns[1], builder.fadd)):
                    change = force if turn is None else builder.shuffle_vector(force, turn, _pick(0, 1, 2, 3))
                    row = _row(builder, rows, indices, k, 4)
                    _store(builder, act(_load(builder, row, width), change), row)
            return context.get_dummy_value()

        return types.void(forces, first, second, types.int64, columns, types.int64), generate

    return add


_ADD = {(count, width): _adding(count, width) for count in (1, 8) for width in (2, 4)}
_add_eight, _add_one = _ADD[8, 2], _ADD[1, 2]
_add_eight_turning, _add_one_turning = _ADD[8, 4], _ADD[1, 4]


def pair_columns(rows, first, second, begin, size, columns, whole):
    """Fills columns (8, >= size) for the pairs begin .. begin + size; the first four if `whole` is None.

    The lists can be read, and name grains, up to a multiple of 8.
    """
    i, j = first[begin : begin + size].astype(int), second[begin : begin + size].astype(int)
    filled = DIFFERENCE_RADIUS if whole is None else SUM_INVERSE_MASS
    columns[:filled, :size] = (rows[j] - rows[i]).T[:filled]
    if whole is not None:
        columns[SUM_INVERSE_MASS:, :size] = (rows[j] + rows[i]).T[[INVERSE_MASS, SPIN]]


@overload(pair_columns, jit_options=OPTIONS)
def _pair_columns(rows, first, second, begin, size, columns, whole):
    fetch = _fetch_lean if whole == types.none else _fetch_whole

    def compiled(rows, first, second, begin, size, columns, whole):
        if rows.shape[0] <= CACHED:
            for k in range(0, size, LANES):
                fetch(rows, first, second, begin + k, columns, k)
            return
        for k in range(0, size, LANES):
            _ask_for_rows(rows, second, min(begin + k + AHEAD, second.size - LANES))
            fetch(rows, first, second, begin + k, columns, k)

    return compiled


def add_to_rows(forces, first, second, begin, size, columns, friction):
    """Adds the columns (F_x, F_y, torques on the first grain taken as -, on the second as +) to the rows of forces, pair by pair."""
    for k in range(size):
        i, j = int(first[begin + k]), int(second[begin + k])
        forces[i, :2] -= columns[:2, k]
        forces[j, :2] += columns[:2, k]
        if friction is not None:
            forces[i, TORQUE] -= columns[2, k]
            forces[j, TORQUE] += columns[3, k]


@overload(add_to_rows, jit_options=OPTIONS)
def _add_to_rows(forces, first, second, begin, size, columns, friction):
    eight, one = (_add_eight, _add_one) if friction == types.none else (_add_eight_turning, _add_one_turning)

    def compiled(forces, first, second, begin, size, columns, friction):
        whole = size - size % LANES
        for k in range(0, whole, LANES):
            eight(forces, first, second, begin + k, columns, k)
        for k in range(whole, size):
            one(forces, first, second, begin + k, columns, k)

    return compiled
