"""A semi-trailer drives as CommonRoad's kinematic single-track model with a trailer (KST)."""

import numpy as np
from scipy.integrate import solve_ivp
from vehiclemodels.parameters_vehicle4 import parameters_vehicle4
from vehiclemodels.vehicle_dynamics_kst import vehicle_dynamics_kst

from hav_env import OffAxle, Rectangles
from tests.support.budgets import budget
from tests.support.worlds import hitch, limit, open_plane, put

STEPS, DT, SPEED = budget(500, 50), 0.2, 1.0


def test_after_a_hundred_metres_it_is_within_a_millimetre():
    model = parameters_vehicle4()
    wheelbase, trailer = model.a + model.b, model.trailer.l_wb
    rng = np.random.default_rng(0)
    angles = np.clip(np.cumsum(rng.normal(0.0, 0.04, STEPS)), -0.5, 0.5)
    batch = open_plane(1, 1, 1, vehicle=OffAxle(bodies=Rectangles()))
    limit(batch.worlds, steering=0.55)
    put(batch.worlds, [wheelbase, trailer])
    hitch(batch.worlds, [0.0])
    state, theirs = batch.worlds.state, np.array([0.0, 0.0, 0.0, SPEED, 0.0, 0.0])
    farthest = bent = 0.0
    for angle in angles:
        theirs[2] = angle
        options = {"rtol": 1e-11, "atol": 1e-12, "method": "DOP853"}
        theirs = solve_ivp(
            # it writes into its argument
            lambda _, x: vehicle_dynamics_kst(list(x), [0.0, 0.0], model),
            (0.0, DT),
            theirs,
            **options,
        ).y[:, -1]
        batch.step(np.full((1, 1), SPEED), np.full((1, 1), angle))
        here = np.array([state.x[0, 0], state.y[0, 0]])
        farthest = max(farthest, np.hypot(*(here - theirs[:2])))
        articulation = state.heading[0, 1, 0] - state.heading[0, 0, 0]
        bent = max(bent, abs(articulation - theirs[5]))
    assert farthest <= 1e-3
    assert bent <= 1e-3
