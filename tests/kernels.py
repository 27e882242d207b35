"""How does a test call an inner kernel? They have no face for Python: this gives them one."""

import numba


def from_python(kernel):
    """``kernel`` as a function that Python can call."""

    @numba.njit(error_model="numpy")
    def call(*args):
        return kernel(*args)

    return call
