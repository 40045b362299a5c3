"""Scratch arrays on the stack, for compiled functions without reference counting, which may not allocate.

A search needs about ten small arrays. Their allocation would cost more than the arithmetic, and a function that
allocates counts references on all of its arrays (measurements: docs/explanation/constants_contact.md#scratch-arrays).
"""

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

_ITEM_BYTES = 8


def scratch(item, *shape):
    """Return a function for compiled code that returns an uninitialised array of float64 or int64 of this fixed shape.

    The array exists until the calling compiled function returns. Each call in the source has one array, so that a call
    in a loop returns the same array every time. The stack of a thread has at least 2 MB; keep the sum of all arrays
    well below 100 kB.
    """
    array_type = _array_type(shape, item)

    @intrinsic
    def take(typing_context):
        def generate(context, builder, signature, arguments):
            return _on_the_stack(context, builder, array_type, shape)

        return array_type(), generate

    return take


def scratch_tuple(kind, **arrays):
    """Return such a function for a NamedTuple of arrays; see `scratch`. arrays: (item, *shape) of each field."""
    fields = [(_array_type(shape, item), shape) for item, *shape in (arrays[name] for name in kind._fields)]
    tuple_type = types.NamedTuple([array_type for array_type, _ in fields], kind)

    @intrinsic
    def take(typing_context):
        def generate(context, builder, signature, arguments):
            values = [_on_the_stack(context, builder, array_type, shape) for array_type, shape in fields]
            return context.make_tuple(builder, tuple_type, values)

        return tuple_type(), generate

    return take


def _array_type(shape, item):
    return types.Array(item, len(shape), "C")


def _on_the_stack(context, builder, array_type, shape):
    """Return the value of an array whose items are on the stack of the function that is being compiled."""

    def constants(values):
        return [context.get_constant(types.intp, int(value)) for value in values]

    data = cgutils.alloca_once(builder, context.get_data_type(array_type.dtype), size=int(np.prod(shape)))
    array = make_array(array_type)(context, builder)
    strides = [_ITEM_BYTES * int(np.prod(shape[k + 1 :])) for k in range(len(shape))]
    populate_array(
        array, data=data, shape=constants(shape), strides=constants(strides),
        itemsize=constants([_ITEM_BYTES])[0], meminfo=None,
    )  # fmt: skip
    return array._getvalue()
