"""Machine forms of :mod:`lostmotion.kernels.lanes`: how Numba types its functions and what LLVM code they become."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from llvmlite import binding, ir
from numba import config, types
from numba.core import cgutils
from numba.extending import lower_builtin, models, register_model, type_callable

Function = TypeVar("Function", bound=Callable[..., Any])
WIDTH, EIGHT = 4, 8


def _has_eight() -> bool:
    """Whether a register of the processor that is compiled for holds eight floats."""
    told: str | None = config.CPU_FEATURES  # type: ignore[attr-defined]
    return "+avx512f" in told if told is not None else bool(binding.get_host_cpu_features().get("avx512f"))


WIDEST = EIGHT if _has_eight() else WIDTH
_VECTOR, _EIGHT = ir.VectorType(ir.DoubleType(), WIDTH), ir.VectorType(ir.DoubleType(), EIGHT)
_PLACE = ir.IntType(32)


class _LanesType(types.Type):
    def __init__(self, name: str, vector: ir.VectorType) -> None:
        super().__init__(name=name)
        self.vector = vector


@register_model(_LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, numba_type.vector)


_QUAD, _OCTET = _LanesType("Quad", _VECTOR), _LanesType("Octet", _EIGHT)
_LANES = object()  # either of them
_FLOATS = types.CPointer(types.float64)


def as_address(meaning: Function) -> Function:
    """Compile `meaning` to the address of the first element of an array."""
    type_callable(meaning)(lambda _context: lambda array: types.CPointer(array.dtype)(array))

    def lower(context: Any, builder: Any, kind: Any, values: Any) -> Any:
        return cgutils.create_struct_proxy(kind.args[0])(context, builder, values[0]).data

    lower_builtin(meaning, types.Array)(lower)
    return meaning


def as_alive(meaning: Function) -> Function:
    """Compile `meaning` to nothing: Numba frees an array behind its last use, and this is one."""
    type_callable(meaning)(lambda _context: lambda _arrays: types.void)
    lower_builtin(meaning, types.Any)(lambda context, *_: context.get_dummy_value())
    return meaning


def _compiler(result: Any, *arguments: Any) -> Callable[[Callable[..., Any]], Callable[[Function], Function]]:
    """Turn code that writes LLVM instructions into a decorator for the Python function that they stand for.

    _LANES are quads or octets, the same in all places.
    """
    some = arguments.index(_LANES) if _LANES in arguments else None

    def of(kind: Any, width: Any) -> Any:
        return width if kind is _LANES else kind

    def given(*found: Any) -> Any:
        width = _QUAD if some is None else found[some]
        return of(result, width)(*(of(argument, width) for argument in arguments))

    typers: dict[int, Any] = {  # Numba counts their parameters
        0: lambda: given(),  # noqa: PLW0108
        1: lambda a: given(a),  # noqa: PLW0108
        2: lambda a, b: given(a, b),  # noqa: PLW0108
        3: lambda a, b, c: given(a, b, c),  # noqa: PLW0108
        4: lambda a, b, c, d: given(a, b, c, d),  # noqa: PLW0108
    }
    typer = typers[len(arguments)]

    def decorator_of(write: Callable[..., Any]) -> Callable[[Function], Function]:
        def compiled(meaning: Function) -> Function:
            type_callable(meaning)(lambda _context: typer)
            for width in (_QUAD,) if some is None else (_QUAD, _OCTET):
                own = [of(argument, width) for argument in arguments]
                lower_builtin(meaning, *own)(lambda _context, builder, _kind, values: write(builder, *values))
            return meaning

        return compiled

    return decorator_of


def _at(builder: Any, floats: Any, at: Any, vector: Any) -> Any:
    return builder.bitcast(builder.gep(floats, [at]), vector.as_pointer())


def _everywhere(builder: Any, values: Any, place: int) -> Any:
    places = ir.Constant(ir.VectorType(_PLACE, values.type.count), [place] * values.type.count)
    return builder.shuffle_vector(values, values, places)


@_compiler(types.void)
def as_widest(builder: Any) -> Any:
    """Marks of the function that is being compiled that llvmlite does not know; none where it forbids them."""
    marks = builder.function.attributes
    if isinstance(marks, set):
        for mark in ("prefer-vector-width", "min-legal-vector-width"):
            set.add(marks, f'"{mark}"="512"')
    return ir.Constant(ir.IntType(8).as_pointer(), None)


@_compiler(_QUAD, _FLOATS, types.intp)
def as_load(builder: Any, floats: Any, at: Any) -> Any:
    """Four neighbours; the address is a multiple of 8 only."""
    return builder.load(_at(builder, floats, at, _VECTOR), align=8)


@_compiler(_OCTET, _FLOATS, types.intp)
def as_load_eight(builder: Any, floats: Any, at: Any) -> Any:
    """Eight neighbours."""
    return builder.load(_at(builder, floats, at, _EIGHT), align=8)


@_compiler(types.void, _FLOATS, types.intp, _LANES)
def as_store(builder: Any, floats: Any, at: Any, values: Any) -> Any:
    """Write neighbours; void is a null pointer to Numba."""
    builder.store(values, _at(builder, floats, at, values.type), align=8)
    return ir.Constant(ir.IntType(8).as_pointer(), None)


@_compiler(_QUAD, types.float64)
def as_spread(builder: Any, value: Any) -> Any:
    """One float in all places."""
    return _everywhere(builder, builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, _PLACE(0)), 0)


@_compiler(_OCTET, types.float64)
def as_spread_eight(builder: Any, value: Any) -> Any:
    """One float in all eight places."""
    return _everywhere(builder, builder.insert_element(ir.Constant(_EIGHT, ir.Undefined), value, _PLACE(0)), 0)


@_compiler(_OCTET, _OCTET)
def as_newest(builder: Any, values: Any) -> Any:
    """The last place in all places."""
    return _everywhere(builder, values, EIGHT - 1)


@_compiler(_OCTET, _OCTET)
def as_second_newest(builder: Any, values: Any) -> Any:
    """The last but one in all places."""
    return _everywhere(builder, values, EIGHT - 2)


@_compiler(_OCTET, _OCTET)
def as_third_newest(builder: Any, values: Any) -> Any:
    """The one before that in all places."""
    return _everywhere(builder, values, EIGHT - 3)


@_compiler(_LANES, _LANES, _LANES)
def as_product(builder: Any, one: Any, other: Any) -> Any:
    """Place by place."""
    return builder.fmul(one, other)


@_compiler(_LANES, _LANES, _LANES)
def as_quotient(builder: Any, one: Any, other: Any) -> Any:
    """Place by place."""
    return builder.fdiv(one, other)


@_compiler(_LANES, _LANES, _LANES)
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


@_compiler(_LANES, _LANES, _LANES)
def as_root_above(builder: Any, left: Any, floor: Any) -> Any:
    """Place by place, without branches."""
    vector = left.type
    infinite = ir.Constant(vector, [float("inf")] * vector.count)
    chosen = builder.select(builder.fcmp_ordered(">", left, floor), left, infinite)
    kind = ir.FunctionType(vector, [vector])
    root = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{vector.count}f64")
    return builder.call(root, [chosen])


@_compiler(_LANES, _LANES, _LANES, _LANES)
def as_fused(builder: Any, start: Any, one: Any, other: Any) -> Any:
    """Multiply and add, rounded once where the processor can: said outright, so that every compilation agrees."""
    kind = ir.FunctionType(start.type, [start.type] * 3)
    fused = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{start.type.count}f64")
    return builder.call(fused, [one, other, start])


@_compiler(types.float64, _QUAD)
def as_total(builder: Any, values: Any) -> Any:
    """Upper half onto lower half, then the pair."""
    halves = [ir.Constant(ir.VectorType(_PLACE, 2), places) for places in ([0, 1], [2, 3])]
    low, high = (builder.shuffle_vector(values, values, half) for half in halves)
    pair = builder.fadd(low, high)
    return builder.fadd(builder.extract_element(pair, _PLACE(0)), builder.extract_element(pair, _PLACE(1)))
