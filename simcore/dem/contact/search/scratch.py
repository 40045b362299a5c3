"""Scratch arrays on the stack: for compiled functions that count no references and so may not allocate.

A search needs some ten small arrays. Allocated, they cost more than the arithmetic (1 µs a search), and an allocating
function counts references on every array it is given (another 1 µs).
"""

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

_ITEM_BYTES = 8


def scratch(item, *shape):
    """Function for compiled code that gives an uninitialised array of float64 or int64 of this fixed shape.

    The array lives as long as the compiled function that asked for it, once for each place in the source: in a loop it
    is the same array every time. Stacks of threads hold 2 MB at least; keep the sum well below 100 kB.
    """
    array_type = types.Array(item, len(shape), "C")
    strides = [_ITEM_BYTES * int(np.prod(shape[k + 1 :])) for k in range(len(shape))]

    @intrinsic
    def take(typing_context):
        def generate(context, builder, signature, arguments):
            def constants(values):
                return [context.get_constant(types.intp, int(value)) for value in values]

            data = cgutils.alloca_once(builder, context.get_data_type(item), size=int(np.prod(shape)))
            array = make_array(array_type)(context, builder)
            populate_array(
                array, data=data, shape=constants(shape), strides=constants(strides),
                itemsize=constants([_ITEM_BYTES])[0], meminfo=None,
            )  # fmt: skip
            return array._getvalue()

        return array_type(), generate

    return take
