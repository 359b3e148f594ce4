"""This module configures Numba's compiler: kernels as parts of entries, and the widest vectors."""

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.untyped_passes import IRProcessing

from hav_env.compiled.precision import MatchConstants


class Whole(JITCodeLibrary):
    """Code for the widest vectors: LLVM would halve those of 512 bits."""

    def add_ir_module(self, ir_module):
        """Add LLVM code, and request vectors of 512 bits in its functions."""
        for function in ir_module.functions:
            set.add(function.attributes, '"prefer-vector-width"="512"')
        super().add_ir_module(ir_module)


class Part(Whole):
    """Code of one kernel; Numba links it into entries, and optimises and finishes it only there.

    By default, Numba would do both for every kernel with all its callees: five times the work.
    """

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name):
        """Return no address: the code is executable only in entries."""
        return 0

    @property
    def codegen(self):
        """Return the library itself, in place of a code generator."""
        return self  # Numba calls only its ``set_env``

    def set_env(self, name, environment):
        """Do nothing: no loaded code could use an environment."""


class RarePart(Part):
    """Code of a kernel that is called, not inlined: LLVM would copy it to every caller."""

    def add_ir_module(self, ir_module):
        """Add LLVM code, and forbid inlining of its functions."""
        for function in ir_module.functions:
            if not function.is_declaration:
                set.add(function.attributes, "noinline")
        super().add_ir_module(ir_module)


class LoopPart(RarePart):
    """Code of the loop of an entry that passes on ``Held`` arguments."""


def compiler_into(library_class: type) -> type:
    """Return Numba's compiler with another library for the generated code.

    The compiler assumes that arrays do not overlap (``noalias``): no two arguments of a loop may
    overlap if one is written. Otherwise every inner loop would begin with a test for overlap.
    """

    @register_pass(mutates_CFG=False, analysis_only=True)
    class ChooseLibrary(AnalysisPass):
        _name = f"choose_{library_class.__name__}"

        def __init__(self):
            super().__init__()

        def run_pass(self, state):
            state.library = library_class(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
            state.flags.noalias = library_class is LoopPart
            return False

    class Compiler(CompilerBase):
        def define_pipelines(self):
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.add_pass_after(ChooseLibrary, IRProcessing)
            passes.add_pass_after(MatchConstants, ChooseLibrary)
            passes.finalize()
            return [passes]

    return Compiler
