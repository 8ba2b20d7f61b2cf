"""Machine forms of :mod:`lostmotion.kernels.lanes`: how Numba types its functions and what LLVM code they become."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import lower_builtin, models, register_model, type_callable

Function = TypeVar("Function", bound=Callable[..., Any])
WIDTH = 4
_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_PLACE = ir.IntType(32)


class _QuadType(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Quad")


@register_model(_QuadType)
class _QuadModel(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, _VECTOR)


_QUAD = _QuadType()
_FLOATS = types.CPointer(types.float64)


def as_address(meaning: Function) -> Function:
    """Compile `meaning` to the address of the first element of an array."""
    type_callable(meaning)(lambda _context: lambda array: types.CPointer(array.dtype)(array))

    def lower(context: Any, builder: Any, kind: Any, values: Any) -> Any:
        return cgutils.create_struct_proxy(kind.args[0])(context, builder, values[0]).data

    lower_builtin(meaning, types.Array)(lower)
    return meaning


def _compiler(result: Any, *arguments: Any) -> Callable[[Callable[..., Any]], Callable[[Function], Function]]:
    """Turn code that writes LLVM instructions into a decorator for the Python function that they stand for."""
    given = result(*arguments)
    typers: dict[int, Any] = {
        1: lambda _a: given,
        2: lambda _a, _b: given,
        3: lambda _a, _b, _c: given,
        4: lambda _a, _b, _c, _d: given,
    }
    typer = typers[len(arguments)]

    def decorator_of(write: Callable[..., Any]) -> Callable[[Function], Function]:
        def compiled(meaning: Function) -> Function:
            type_callable(meaning)(lambda _context: typer)
            lower_builtin(meaning, *arguments)(lambda _context, builder, _kind, values: write(builder, *values))
            return meaning

        return compiled

    return decorator_of


def _quad_at(builder: Any, floats: Any, at: Any) -> Any:
    return builder.bitcast(builder.gep(floats, [at]), _VECTOR.as_pointer())


@_compiler(_QUAD, _FLOATS, types.intp)
def as_load(builder: Any, floats: Any, at: Any) -> Any:
    """Four neighbours; the address is a multiple of 8 only."""
    return builder.load(_quad_at(builder, floats, at), align=8)


@_compiler(types.void, _FLOATS, types.intp, _QUAD)
def as_store(builder: Any, floats: Any, at: Any, values: Any) -> Any:
    """Write four neighbours; void is a null pointer to Numba."""
    builder.store(values, _quad_at(builder, floats, at), align=8)
    return ir.Constant(ir.IntType(8).as_pointer(), None)


@_compiler(_QUAD, types.float64)
def as_spread(builder: Any, value: Any) -> Any:
    """One float in all places."""
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, _PLACE(0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(_PLACE, WIDTH), [0] * WIDTH))


@_compiler(_QUAD, _QUAD, _QUAD)
def as_product(builder: Any, one: Any, other: Any) -> Any:
    """Place by place."""
    return builder.fmul(one, other)


@_compiler(_QUAD, _QUAD, _QUAD)
def as_quotient(builder: Any, one: Any, other: Any) -> Any:
    """Place by place."""
    return builder.fdiv(one, other)


@_compiler(_QUAD, _QUAD, _QUAD)
def as_difference(builder: Any, one: Any, other: Any) -> Any:
    """Place by place."""
    return builder.fsub(one, other)


@_compiler(_QUAD, _QUAD, _QUAD, _QUAD, _QUAD)
def as_choice(builder: Any, left: Any, right: Any, one: Any, other: Any) -> Any:
    """Place by place, without branches."""
    return builder.select(builder.fcmp_ordered(">", left, right), one, other)


@_compiler(_QUAD, _QUAD)
def as_whole(builder: Any, values: Any) -> Any:
    """Place by place."""
    kind = ir.FunctionType(_VECTOR, [_VECTOR])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.floor.v{WIDTH}f64"), [values])


@_compiler(_QUAD, _QUAD, _QUAD)
def as_root_above(builder: Any, left: Any, floor: Any) -> Any:
    """Place by place, without branches."""
    infinite = ir.Constant(_VECTOR, [float("inf")] * WIDTH)
    chosen = builder.select(builder.fcmp_ordered(">", left, floor), left, infinite)
    root = cgutils.get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), f"llvm.sqrt.v{WIDTH}f64")
    return builder.call(root, [chosen])


@_compiler(_QUAD, _QUAD, _QUAD, _QUAD)
def as_fused(builder: Any, start: Any, one: Any, other: Any) -> Any:
    """Multiply and add, rounded once where the processor can: said outright, so that every compilation agrees."""
    kind = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
    fused = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{WIDTH}f64")
    return builder.call(fused, [one, other, start])


@_compiler(types.float64, _QUAD)
def as_total(builder: Any, values: Any) -> Any:
    """Upper half onto lower half, then the pair."""
    halves = [ir.Constant(ir.VectorType(_PLACE, 2), places) for places in ([0, 1], [2, 3])]
    low, high = (builder.shuffle_vector(values, values, half) for half in halves)
    pair = builder.fadd(low, high)
    return builder.fadd(builder.extract_element(pair, _PLACE(0)), builder.extract_element(pair, _PLACE(1)))
