"""This package compiles the simulator; it is the only package that imports Numba.

It has three tiers. A ``kernel`` is compiled into its callers: scalar (floats in, floats out) or a
loop over the lanes of a block of worlds. A ``generic`` picks a kernel by the type of a model.
Python calls an ``entry``. Only entries are cached on disk, and they spread their worlds over
threads.
"""

from hav_env.compiled.digests import Code, classes_in, digest_code
from hav_env.compiled.entries import canonical, entry
from hav_env.compiled.held import Held, arguments_of
from hav_env.compiled.instructions import (
    TILE_SIDE,
    contiguous,
    fixed,
    fma,
    lanes_from,
    lowest_bit,
    of_width,
    split_power,
    take,
    transpose_tile,
)
from hav_env.compiled.kernels import generic, kernel, loop_kernel, rare_kernel
from hav_env.compiled.precision import (
    ZEROS,
    either,
    like,
    narrow,
    rounder_of,
    single,
    two_to,
    whole_in,
)
from hav_env.compiled.registers import local_array, local_singles, shift_up
from hav_env.compiled.sharing import VECTOR
from hav_env.compiled.threads import NO_HELPERS, crew_of, default_threads, run_on_threads

__all__ = [
    "NO_HELPERS",
    "TILE_SIDE",
    "VECTOR",
    "ZEROS",
    "Code",
    "Held",
    "arguments_of",
    "canonical",
    "classes_in",
    "contiguous",
    "crew_of",
    "default_threads",
    "digest_code",
    "either",
    "entry",
    "fixed",
    "fma",
    "generic",
    "kernel",
    "lanes_from",
    "like",
    "local_array",
    "local_singles",
    "loop_kernel",
    "lowest_bit",
    "narrow",
    "of_width",
    "rare_kernel",
    "rounder_of",
    "run_on_threads",
    "shift_up",
    "single",
    "split_power",
    "take",
    "transpose_tile",
    "two_to",
    "whole_in",
]
