"""Loops over lanes work on vectors: none has fallen back to one lane at a time."""

import platform
import re

import numba
import pytest

from hav_env.compiled import VECTOR, fixed, kernel, like
from hav_env.compiled.entries import _signature
from hav_env.compiled.kernels import ENTERED, LOOPED
from hav_env.compiled.sharing import spread
from hav_env.mdp.buffers import buffers_from, outcome_from
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation.layout import FIRST_OF_ROUTE, FIRST_OF_UNITS
from hav_env.observation.own import observe_itself
from hav_env.observation.route import observe_route, plan_route
from hav_env.vehicles import Limited, OffAxle, OnAxle, Rectangles, actuate, move
from hav_env.world.bodies import enclose
from hav_env.world.lanes import block_of
from hav_env.world.other_havs import find_nearest_points
from tests.support.budgets import COMPILED

pytestmark = pytest.mark.skipif(
    not COMPILED or platform.machine() not in ("x86_64", "AMD64"),
    reason="reads the compiled code of one kind of processor",
)
AGENT, OTHER = 0, 1
VEHICLE, OFF_AXLE, LIMITED = OnAxle(), OffAxle(), Limited()
ARITHMETIC = r"\tv?(?:add|sub|mul|div|sqrt|min|max|fn?m(?:add|sub)\d*)"
ON_DOUBLES = re.compile(ARITHMETIC + r"[sp]d\b")
ON_ONE, ON_VECTORS = re.compile(ARITHMETIC + r"s[sd]\b"), re.compile(ARITHMETIC + r"p[sd]\b")


def move_havs(world, own, result):
    move(VEHICLE, 0.2, world, AGENT)


def move_off_axle(world, own, result):
    move(OFF_AXLE, 0.2, world, AGENT)


def follow_commands(world, own, result):
    actuate(LIMITED, 0.2, world, AGENT, own.command[0], own.command[1])


def plan_routes(world, own, result):
    plan_route(world, AGENT, own.scratch, own.remaining)


def observe_routes(world, own, result):
    observe_route(world, own.scratch, own.columns, FIRST_OF_ROUTE)


def observe_havs(world, own, result):
    observe_itself(world, AGENT, own.scratch, own.columns, FIRST_OF_UNITS)


def enclose_a_hav(world, own, result):
    enclose(world, fixed(AGENT))


def look_at_others(world, own, result):
    find_nearest_points(world, AGENT, OTHER, own.scratch.chain)


@pytest.fixture(scope="module")
def arrays():
    process = DecisionProcess(64)
    return process.batch.worlds, process._buffers, process.outcome()


def instructions(stage, *args):
    """Return how many instructions of a stage work on one number, and how many on vectors."""
    code = assembly(stage, *args)
    return len(ON_ONE.findall(code)), len(ON_VECTORS.findall(code))


def assembly(stage, *args):
    """Return the instructions of a loop over a stage."""
    inlined = kernel(stage)

    def loop(first, last, worlds, buffers, outcome):
        world = block_of(worlds, first, last - first, worlds.units)
        inlined(world, buffers_from(buffers, first, 0), outcome_from(outcome, first))

    part = numba.njit(**LOOPED)(loop)

    def call(crew, count, args):
        spread(part, args, count, VECTOR, crew)

    compiled = numba.njit(**ENTERED)(call)
    compiled.compile(_signature(args))
    return "".join(compiled.inspect_asm().values())


@pytest.mark.parametrize(
    "stage",
    [
        *(move_havs, observe_routes),
        *(
            pytest.param(stage, marks=pytest.mark.exhaustive)
            for stage in (follow_commands, plan_routes, observe_havs, look_at_others)
        ),
    ],
)
def test_what_is_left_over_of_vectors_is_all_that_is_done_lane_by_lane(stage, arrays):
    """Every loop has a vector part and one for the lanes left over, of the same instructions."""
    on_one, on_vectors = instructions(stage, *arrays)
    assert on_vectors > 10
    assert on_one <= 1.25 * on_vectors, (on_one, on_vectors)


def test_a_loop_that_asks_lane_by_lane_would_be_noticed(arrays):
    def drive_in_turn(world, own, result):
        far = 0.0
        for lane in range(world.lanes):
            far = 0.5 * far + world.state.x[AGENT, lane]  # each lane waits for the one before
            world.state.y[AGENT, lane] = far

    on_one, on_vectors = instructions(drive_in_turn, *arrays)
    assert on_one > 1.25 * on_vectors


@pytest.mark.exhaustive
@pytest.mark.parametrize("stage", [move_off_axle, look_at_others])
def test_the_same_holds_for_hitches_and_rectangles(stage):
    process = DecisionProcess(64, vehicle=OffAxle(bodies=Rectangles()))
    on_one, on_vectors = instructions(
        stage, process.batch.worlds, process._buffers, process.outcome()
    )
    assert on_vectors > 10
    assert on_one <= 1.25 * on_vectors, (on_one, on_vectors)


@pytest.mark.parametrize("vehicle", [VEHICLE, OffAxle(bodies=Rectangles())])
def test_boxes_are_found_on_vectors(vehicle):
    """The lanes left over of the short loop before the units are unrolled: 8 instructions more."""
    process = DecisionProcess(64, vehicle=vehicle)
    args = process.batch.worlds, process._buffers, process.outcome()
    on_one, on_vectors = instructions(enclose_a_hav, *args)
    assert on_vectors > 10
    assert on_one <= 1.25 * on_vectors + 8, (on_one, on_vectors)


def test_worlds_in_single_precision_are_moved_without_doubles(arrays):
    def move_a_hav(world, own, result):
        dt = like(0.2, world.state.x[AGENT, 0])
        move(VEHICLE, dt, world, AGENT)

    process = DecisionProcess(64, precision="single")
    code = assembly(move_a_hav, process.batch.worlds, process._buffers, process.outcome())
    assert len(ON_VECTORS.findall(code)) > 10
    assert not ON_DOUBLES.findall(code)
    assert ON_DOUBLES.findall(assembly(move_a_hav, *arrays))
