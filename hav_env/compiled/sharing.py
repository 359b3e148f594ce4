"""This module shares a loop over worlds among threads, in compiled code that holds no GIL.

A helper is a Python thread that enters compiled code once and waits there. It takes a range of
worlds, and reports its end, through Python's own locks, which need no GIL. Waking a thread through
Python would take as long as a step of a thousand worlds.
"""

import ctypes
import sys
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.core.callconv import RETCODE_OK, excinfo_ptr_t
from numba.extending import lower_builtin, type_callable

from hav_env.compiled.held import Held, HeldType, arguments_of
from hav_env.compiled.kernels import RARE

VECTOR = 16  # lanes of one block of whole vectors
# A thread tries for a lock before it sleeps, because waking takes 20 to 50 us. A try takes 20 to
# 60 ns, so all of them take some 100 us. If they were in vain, as between the steps of a learner or
# on a busy core, the thread sleeps at once in its next waits, and tries again in the eighth.
_MOST_TRIES, _WAITS = 4_000, 8
_MAILBOX, _SET = 32, 16  # words of a mailbox and of a set of cores, which is its second half
# words of a mailbox: two locks, a job and its range, waits in which a thread has slept, the core of
# the caller, and the address of the set
_GO, _DONE, _JOB, _START, _STOP, _SLEPT, _CALLER_SLEPT, _CORE, _SET_AT = range(9)

_int32, _int64, _Integer = numba.int32, numba.int64, numba.types.Integer
_take = numba.types.ExternalFunction("PyThread_acquire_lock", _int32(_int64, _int32))
_free = numba.types.ExternalFunction("PyThread_release_lock", numba.void(_int64))
_core_here = numba.types.ExternalFunction("sched_getcpu", _int32())
_cores_of, _restrict = (
    numba.types.ExternalFunction(name, _int32(_int32, _int64, _int64))
    for name in ("sched_getaffinity", "sched_setaffinity")
)
_python = ctypes.pythonapi
_take_from_python = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int)(
    ("PyThread_acquire_lock", _python)
)
_free_from_python = ctypes.PYFUNCTYPE(None, ctypes.c_void_p)(("PyThread_release_lock", _python))
_new_lock = ctypes.PYFUNCTYPE(ctypes.c_void_p)(("PyThread_allocate_lock", _python))

# parts of a job: its function, the code and the description of an error, and the arguments
_RUN, _CODE, _ERROR, _ARGUMENTS = (ir.Constant(ir.IntType(32), k) for k in range(4))
_ZERO = ir.Constant(ir.IntType(32), 0)
_RANGE = _int64, _int64, _int64  # of a job: its address, first and last


def make_crew(helpers: int) -> Held:
    """Return a lock, which is free, and the mailboxes of helpers: a crew."""
    mailboxes = np.zeros((helpers, _MAILBOX), np.int64)
    for mailbox in mailboxes:
        mailbox[[_GO, _DONE]] = locks = _new_lock(), _new_lock()
        for lock in locks:
            _take_from_python(lock, 0)
        mailbox[_SET_AT] = mailbox[_MAILBOX - _SET :].ctypes.data
    return Held(_new_lock(), mailboxes)


def dismiss(crew: Held) -> bool:
    """Let the helpers of a crew leave ``serve``, unless it is at work; return whether they do."""
    lock, mailboxes = crew.arguments
    free = _take_from_python(lock, 0) == 1
    if free:  # and never again: all later callers work alone
        for mailbox in mailboxes:
            mailbox[_JOB] = 0
            _free_from_python(int(mailbox[_GO]))
    return free


def serve(mailbox):
    """Work at a mailbox (``_MAILBOX``,) until the crew is dismissed."""
    while True:
        _wait(mailbox[_GO], mailbox[_SLEPT:])
        if mailbox[_JOB] == 0:
            return
        run_range(mailbox[_JOB], mailbox[_START], mailbox[_STOP])
        _free(mailbox[_DONE])
        _step_aside(mailbox)


def _note(mailbox):
    """Write the core on which the caller of a helper runs."""
    mailbox[_CORE] = _core_here()


def _leave(mailbox):
    """Move this thread away from its caller's core, where both would run in turn.

    Linux often wakes a thread on the core of its caller, even if another one is idle, and leaves
    both there for thousands of calls.
    """
    core, size, cores = _core_here(), 8 * _SET, mailbox[_MAILBOX - _SET :]
    word, bit = core // 64, 1 << (core % 64)
    if core != mailbox[_CORE] or word >= _SET or _cores_of(0, size, mailbox[_SET_AT]) < 0:
        return
    for _ in range(2):  # without the core, and with it again
        cores[word] ^= bit
        _restrict(0, size, mailbox[_SET_AT])


def _stay(mailbox):
    """Leave the choice of cores to the system."""


_moves = sys.platform == "linux"
_note_core = numba.njit(**RARE)(_note if _moves else _stay)
_step_aside = numba.njit(**RARE)(_leave if _moves else _stay)


@numba.njit(**RARE)
def _wait(lock, slept):
    """Take a lock, and count in ``slept[0]`` the waits since tries have last sufficed."""
    if slept[0] % _WAITS == 0:
        for _ in range(_MOST_TRIES):
            if _take(lock, 0) == 1:
                slept[0] = 0
                return
    slept[0] += 1
    _take(lock, 1)


@numba.njit(**RARE)
def _share(crew, count, portion, job):
    """Run a job over ``count`` worlds, on this thread and the helpers of a crew if it is free.

    The range of each thread, except the last, is a multiple of the portion.
    """
    lock, mailboxes = arguments_of(crew)
    parts = portion * (mailboxes.shape[0] + 1)
    own = (count + parts - 1) // parts * portion
    if count <= own or _take(lock, 0) == 0:
        run_range(job, 0, count)
        return
    others = (count - 1) // own
    for k in range(others):
        mailbox = mailboxes[k]
        mailbox[_JOB], mailbox[_START] = job, (k + 1) * own
        mailbox[_STOP] = min(mailbox[_START] + own, count)
        _note_core(mailbox)
        _free(mailbox[_GO])
    run_range(job, 0, own)
    for k in range(others):
        mailbox = mailboxes[k]
        if _take(mailbox[_GO], 0) == 1:  # the helper has not begun: it sleeps, or has no core
            run_range(job, mailbox[_START], mailbox[_STOP])
        else:
            _wait(mailbox[_DONE], mailbox[_CALLER_SLEPT:])
    _free(lock)


def spread(loop, args, count, portion, crew):
    """Run ``loop(first, last, *args)`` over ``count`` worlds, on the threads of a crew.

    Errors of the loop are raised after all threads are done. Each ``first`` is a multiple of the
    portion.
    """
    loop(0, count, *args)


def run_range(job, first, last):
    """Run a job, the address of a table that ``spread`` wrote, over a range of worlds."""


type_callable(run_range)(lambda context: lambda job, first, last: numba.void)


@type_callable(spread)
def _type_spread(context: Any) -> Any:
    def compile_both(loop, args, count, portion, crew):
        loop.get_call_type(context, (_int64, _int64, *args.types), {})
        numba.typeof(_share).get_call_type(context, (crew, *_RANGE), {})
        return numba.void

    return compile_both


@lower_builtin(spread, numba.types.Dispatcher, numba.types.BaseTuple, _Integer, _Integer, HeldType)
def _lower_spread(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    loop, args, _, _, crew = signature.args
    _, values, count, portion, mailboxes = arguments
    portion = context.cast(builder, portion, signature.args[3], _int64)
    run = _write_run(context, builder, loop, args)
    kinds = run.type, ir.IntType(32), excinfo_ptr_t, values.type
    job = cgutils.alloca_once(builder, ir.LiteralStructType(kinds))
    for place, value in ((_RUN, run), (_CODE, RETCODE_OK), (_ARGUMENTS, values)):
        builder.store(value, builder.gep(job, [_ZERO, place]))
    share, kinds = numba.typeof(_share), (crew, *_RANGE)
    call = context.get_function(share, share.get_call_type(context.typing_context, kinds, {}))
    call(builder, (mailboxes, count, portion, builder.ptrtoint(job, ir.IntType(64))))
    code, error = (builder.load(builder.gep(job, [_ZERO, place])) for place in (_CODE, _ERROR))
    status = context.call_conv._get_return_status(builder, code, error)
    with cgutils.if_unlikely(builder, status.is_error):
        context.call_conv.return_status_propagate(builder, status)
    return context.get_dummy_value()


def _write_run(context: Any, builder: Any, loop: Any, args: Any) -> Any:
    """Return a function ``(job, first, last)`` that runs a loop with the arguments in a job."""
    kind = context.call_conv.get_function_type(numba.void, _RANGE)
    run = ir.Function(builder.module, kind, f"{builder.function.name}.run")
    run.linkage = "internal"
    job, first, last = context.call_conv.get_arguments(run)
    inner = ir.IRBuilder(run.append_basic_block())
    values = context.get_value_type(args)
    table = ir.LiteralStructType([kind.as_pointer(), ir.IntType(32), excinfo_ptr_t, values])
    place = inner.gep(inner.inttoptr(job, table.as_pointer()), [_ZERO, _ARGUMENTS])
    unpacked = cgutils.unpack_tuple(inner, inner.load(place), len(args))
    kinds = _int64, _int64, *args.types
    call = context.get_function(loop, loop.get_call_type(context.typing_context, kinds, {}))
    call(inner, (first, last, *unpacked))
    inner.ret(RETCODE_OK)
    return run


@lower_builtin(run_range, _Integer, _Integer, _Integer)
def _lower_run_range(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind = context.call_conv.get_function_type(numba.void, _RANGE)
    table = ir.LiteralStructType([kind.as_pointer(), ir.IntType(32), excinfo_ptr_t])
    job = builder.inttoptr(arguments[0], table.as_pointer())
    nothing = cgutils.alloca_once(builder, kind.args[0].pointee)
    error = cgutils.alloca_once(builder, excinfo_ptr_t)
    run = builder.load(builder.gep(job, [_ZERO, _RUN]))
    code = builder.call(run, [nothing, error, *arguments])
    with cgutils.if_unlikely(builder, builder.icmp_signed("!=", code, RETCODE_OK)):
        builder.store(builder.load(error), builder.gep(job, [_ZERO, _ERROR]))
        builder.store(code, builder.gep(job, [_ZERO, _CODE]))
    return context.get_dummy_value()
