"""How is an inner kernel compiled? To LLVM's intermediate code, which its callers take in; no machine code.

numba optimises every function with all that it calls, and makes machine code of it: for inner kernels, which
never run alone, two fifths of a first shot's time. So their library is complete as it is; the entry kernel
that takes them in optimises all at once, and callers find them under an entry point that is only a name. And
numba works out anew what each operator gives for its types, a seventh of the time: here the first answer
stays.

It uses parts of numba that are not public; without them numba compiles as usual: the same results, later.
"""

from contextlib import contextmanager
from typing import Any

from numba.core import codegen, compiler
from numba.core.registry import CPUDispatcher
from numba.core.types.functions import BaseFunction, Function

FIND = "get_call_type"
"""The method of numba's functions that finds what they give for some types."""
_OF_CODE = (
    "optimize_final_module",
    "finalize_final_module",
    "finalize_dynamic_globals",
    "verify_declare_only_symbols",
)
_PARTS = (
    (codegen.JITCodeLibrary, tuple(f"_{name}" for name in _OF_CODE)),
    (compiler.CompileResult, ("_replace", "entry_point")),
    (CPUDispatcher, ("add_overload",)),
    (compiler.Compiler, ("compile_extra",)),
    (BaseFunction, (FIND,)),
)
KNOWN = all(hasattr(owner, name) for owner, names in _PARTS for name in names)
"""Whether this numba has the parts."""


class _Library(codegen.JITCodeLibrary):
    """Code to be linked into that of callers, and optimised there."""

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


_found: dict[Any, Any] = {}
_find: Any = getattr(BaseFunction, FIND, None)


def _find_once(function, context, args, kws):
    """What ``function`` gives for these types: as before, if they alone decide, or by ``_find``."""
    if type(function) is not Function or kws:
        return _find(function, context, args, kws)
    called, known = getattr(function, "typing_key", None), getattr(function, "_impl_keys", {})
    signature = _found.get((called, args))
    if signature is None or signature.args not in known:
        signature = _find(function, context, args, kws)
        # else it was compiled for its caller's options
        if called is not None and known.get(signature.args) is called:
            _found[called, args] = signature
    return signature


@contextmanager
def _finding_once():
    """Let numba use ``_find_once``; whoever compiles holds numba's lock, so no other thread does."""
    before = getattr(BaseFunction, FIND)
    setattr(BaseFunction, FIND, _find_once)
    try:
        yield
    finally:
        setattr(BaseFunction, FIND, before)


class _Compiler(compiler.Compiler):
    """Compiles one inner kernel."""

    def __init__(self, typingctx, targetctx, library, args, return_type, flags, locals):
        made = targetctx.codegen()
        flags = flags.copy()
        flags.no_compile = True
        super().__init__(
            typingctx, targetctx, _Library(made, "inner kernel"), args, return_type, flags, locals
        )

    def compile_extra(self, func):
        with _finding_once():
            return super().compile_extra(func)


class EntryPoint:
    """What stands for the machine code that an inner kernel does not have."""


class Inner(CPUDispatcher):
    """What ``_jit.kernel`` makes of a function: other kernels can call it, and Python cannot."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Raise TypeError."""
        raise TypeError(f"{self.py_func.__qualname__} is an inner kernel: only kernels can call it")

    if KNOWN:

        def add_overload(self, cres: Any) -> None:
            """Keep what was compiled for one signature."""
            cres = cres._replace(entry_point=EntryPoint())
            cres.target_context.insert_user_function(cres.entry_point, cres.fndesc, [cres.library])
            self.overloads[tuple(cres.signature.args)] = cres


OPTIONS: dict[str, Any] = {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Of ``numba.njit``. Without ``_nrt`` a kernel makes no arrays and counts no references (see ``kernel``)."""
if KNOWN:
    OPTIONS["pipeline_class"] = _Compiler
