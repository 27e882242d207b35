"""How is an inner kernel compiled? To LLVM's intermediate code, which its callers take in; no machine code.

By default numba optimises every function with all that it calls, and makes machine code of it: for inner kernels,
which never run alone, two fifths of a first shot's time. Here an entry kernel takes in each inner kernel once and
optimises all together. An inner kernel also skips passes for closures and exceptions, reference counts, a compile
for each value of a constant integer and numba's clocks. It cannot raise, so that no call asks whether it did.

This needs parts of numba that are not public; without them numba compiles as usual: the same results, later."""

from contextlib import contextmanager
from typing import Any

from llvmlite import binding
from numba.core import base, cgutils, codegen, compiler, lowering, sigutils, typed_passes, types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import register_pass
from numba.core.registry import CPUDispatcher
from numba.core.types.functions import BaseFunction, Function

FIND = "get_call_type"  # the method of numba's functions that finds what they give for some types
_PARTS = (
    (base.BaseContext, ("declare_function", "get_arg_packer", "get_returned_value", "insert_func_defn")),
    (codegen.JITCodeLibrary, ("_optimize_functions", "_optimize_final_module")),
    (codegen.JITCPUCodegen, ("_function_pass_manager",)),
    (compiler.CompileResult, ("_replace", "entry_point")),
    (compiler.Compiler, ("compile_extra", "define_pipelines")),
    (compiler.Flags(), ("_values",)),
    (lowering.Lower, ("alloca_lltype", "incref", "decref", "delvar")),
    (CPUDispatcher, ("add_overload", "get_call_template")),
    (BaseFunction, (FIND,)),
)
_ONE_FOR_ALL = codegen.JITCPUCodegen._function_pass_manager.__code__.co_argcount == 1  # 0.61: one a module
KNOWN = _ONE_FOR_ALL and all(hasattr(owner, name) for owner, names in _PARTS for name in names)
"""Whether this numba has the parts."""


class _Code(codegen.JITCodeLibrary):
    """Code of one kernel."""

    def add_ir_module(self, ir_module):
        """Take this code in, and let go of the module's text: some three million objects that refer to each other."""
        super().add_ir_module(ir_module)
        for function in ir_module.functions:
            for block in function.blocks:
                block.instructions, block.terminator = [], None
            function.args, function.blocks = (), []

    def _optimize_functions(self, ll_module):
        """As numba does, but with one manager of passes for all functions, and none for declarations."""
        ll_module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager()
        for function in ll_module.functions:
            if not function.is_declaration:
                passes.run(function, builder)


class _Library(_Code):
    """Code to be linked into that of callers, and optimised there."""

    def finalize(self):
        """Let callers link it as it is; they link all that it calls too (see ``Inner.add_overload``)."""
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == binding.Linkage.external:
                function.linkage = "weak_odr"  # not "linkonce": LLVM would link what is referred to already
        self._shared_module = self._final_module
        if hasattr(self, "_reload_init"):  # not in 0.62
            for library in self._linking_libraries:
                self._reload_init.update(library._reload_init)
        self._finalized = True


class _EntryLibrary(_Code):
    """Code of an entry kernel, with that of all inner kernels that it uses."""

    def _optimize_final_module(self):
        for function in self._final_module.functions:
            if function.linkage == binding.Linkage.weak_odr:
                function.linkage = "linkonce_odr"  # it goes if all its callers have taken it in
        super()._optimize_final_module()


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


_UNUSED = "WithLifting InlineClosureLikes RewriteDynamicRaises MakeFunctionToJitFunction FindLiterallyCalls "
_UNUSED += "LiteralUnroll LiteralPropagationSubPipelinePass InlineOverloads NopythonRewrites "
_UNUSED += "NoPythonSupportedFeatureValidation DumpParforDiagnostics IRLegalization AnnotateTypes"
"""Passes of numba for what no inner kernel has (contexts, closures, exceptions, literals, sums of arrays) or needs
(the end of each variable, notes of its type)."""


_HASH = hash(compiler.Flags())  # of the names of all flags


class _Flags(compiler.Flags):
    """Numba's flags, which are compared 50,000 times: first those that were set, then if need be all."""

    def __eq__(self, other):
        return (isinstance(other, _Flags) and self._values == other._values) or super().__eq__(other)

    def __hash__(self):
        return _HASH


class _Lower(lowering.Lower):
    """Writes LLVM's code of an inner kernel, which counts no references and is not for a debugger."""

    def alloca_lltype(self, name, lltype, datamodel=None):
        return cgutils.alloca_once(self.builder, lltype, name=name, zfill=False)

    def incref(self, typ, val):
        pass

    decref = incref

    def delvar(self, name):
        pass


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(typed_passes.NativeLowering):
    """Writes it by ``_Lower``."""

    _name = "lowering of inner kernels"
    lowering_class: Any = _Lower


class _Compiler(compiler.Compiler):
    """Compiles one inner kernel."""

    def __init__(self, typingctx, targetctx, library, args, return_type, flags, locals):
        code, ours = _Library(targetctx.codegen(), "inner kernel"), _Flags(flags)
        setattr(ours, "no_compile", True)  # noqa: B010 - a type checker does not know it
        super().__init__(typingctx, targetctx, code, args, return_type, ours, locals)

    def define_pipelines(self):
        (passes,) = super().define_pipelines()
        of_ours, unused = {typed_passes.NativeLowering: _Lowering}, _UNUSED.split()
        kept = [(made, what) for made, what in passes.passes if made.__name__ not in unused]
        passes.passes = [(of_ours.get(made, made), what) for made, what in kept]
        passes.finalize()
        return [passes]

    def compile_extra(self, func):
        with _finding_once():
            return super().compile_extra(func)


class _EntryCompiler(compiler.Compiler):
    """Compiles one entry kernel."""

    def compile_extra(self, func):
        state: Any = self.state
        state.flags = _Flags(state.flags)
        state.library = _EntryLibrary(state.targetctx.codegen(), func.__qualname__)
        state.library.enable_object_caching()
        return super().compile_extra(func)


def _calling(called, libraries):
    """What writes a call of ``called``: as numba does, but without the checks whether it raised, for it does not."""

    def call(context, builder, _, args):
        function = context.declare_function(builder.module, called)
        result = cgutils.alloca_once(builder, function.args[0].type.pointee)
        args = context.get_arg_packer(called.argtypes).as_arguments(builder, args)
        builder.call(function, [result, builder.function.args[1], *args])  # the second: where an error is put
        return context.get_returned_value(builder, called.restype, builder.load(result))

    call.libs = tuple(libraries)
    return call


class Inner(CPUDispatcher):
    """What ``jit.kernel`` makes of a function: other kernels can call it, and Python cannot."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Raise TypeError."""
        raise TypeError(f"{self.py_func.__qualname__} is an inner kernel: only kernels can call it")

    if KNOWN:

        def get_call_template(self, args: Any, kws: Any) -> Any:
            """What it gives for these types; a constant integer is an integer, or each would be compiled anew."""
            plain = types.IntegerLiteral, types.BaseTuple
            args = [types.unliteral(a) if isinstance(a, plain) else a for a in args]
            return super().get_call_template(args, kws)

        def compile(self, sig: Any) -> Any:
            """Compile it for these types, without numba's clocks and disk cache, which slow each call into LLVM."""
            args, return_type = sigutils.normalize_signature(sig)
            with global_compiler_lock, self._compiling_counter:
                if args not in self.overloads:
                    compiler: Any = getattr(self, "_compiler")  # noqa: B009 - a type checker does not know it
                    self.add_overload(compiler.compile(args, return_type))
            return self.overloads[args].entry_point

        def add_overload(self, cres: Any) -> None:
            """Keep what was compiled for one signature."""
            cres = cres._replace(entry_point=object())  # in place of machine code, which it has not
            libraries = list(dict.fromkeys([cres.library, *cres.library._linking_libraries]))
            context, called = cres.target_context, cres.fndesc
            if isinstance(called.restype, types.Optional):  # a code tells whether it is None
                context.insert_user_function(cres.entry_point, called, libraries)
            else:
                call = _calling(called, libraries)
                context.insert_func_defn([(call, cres.entry_point, called.argtypes)])
            self.overloads[tuple(cres.signature.args)] = cres


OPTIONS: dict[str, Any] = {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Of ``numba.njit``. Without ``_nrt`` a kernel makes no arrays and counts no references (see ``kernel``)."""
ENTRY_OPTIONS: dict[str, Any] = {"no_cfunc_wrapper": True}
if KNOWN:
    OPTIONS["pipeline_class"] = _Compiler
    ENTRY_OPTIONS["pipeline_class"] = _EntryCompiler
