"""This module configures Numba's compiler: kernels as parts of entries, and the widest vectors."""

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.untyped_passes import IRProcessing


class Whole(JITCodeLibrary):
    """Code for the widest vectors: LLVM would halve those of 512 bits."""

    def add_ir_module(self, ir_module):
        """Add code of LLVM, and ask for vectors of 512 bits in its functions."""
        for function in ir_module.functions:
            set.add(function.attributes, '"prefer-vector-width"="512"')
        super().add_ir_module(ir_module)


class Part(Whole):
    """The code of one kernel: linked into entries, and optimised and made executable there only.

    Numba would do both for every kernel, with all that it calls: five times the work.
    """

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name):
        """Return no address: the code is executable in entries only."""
        return 0

    @property
    def codegen(self):
        """The library itself, in place of a generator of code."""
        return self  # Numba asks it for ``set_env`` alone

    def set_env(self, name, environment):
        """Do nothing: no code is loaded that could use an environment."""


class RarePart(Part):
    """The code of a kernel that is called: LLVM would put copies of it wherever it is."""

    def add_ir_module(self, ir_module):
        """Add code of LLVM, and forbid copies of its functions inside their callers."""
        for function in ir_module.functions:
            if not function.is_declaration:
                set.add(function.attributes, "noinline")
        super().add_ir_module(ir_module)


class LoopPart(RarePart):
    """The code of the loop of an entry that hands on what is held."""


def compiler_into(library_class: type) -> type:
    """Return Numba's compiler, but for where the code goes.

    Arrays are taken to lie apart (``noalias``): no two arguments of a loop may overlap where one
    is written. Otherwise every loop inside would begin by asking.
    """

    @register_pass(mutates_CFG=False, analysis_only=True)
    class ChooseLibrary(AnalysisPass):
        _name = f"choose_{library_class.__name__}"

        def __init__(self):
            super().__init__()

        def run_pass(self, state):
            state.library = library_class(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
            state.flags.noalias = library_class in (Whole, LoopPart)
            return False

    class Compiler(CompilerBase):
        def define_pipelines(self):
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.add_pass_after(ChooseLibrary, IRProcessing)
            passes.finalize()
            return [passes]

    return Compiler
