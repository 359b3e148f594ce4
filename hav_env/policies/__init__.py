"""This package defines policies: their kernels, their memory, their names and their driver.

A policy is a NamedTuple of parameters and a kernel that decides from the sensing of one HAV.
"""

from hav_env.policies.checks import check_parameters, check_policy, check_rules
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.filtered import Filtered
from hav_env.policies.interface import (
    act,
    act_lanes,
    allocate_memory,
    broadcast_size,
    decide,
    evaded,
    heard,
    joint_weights,
    memory_size,
)
from hav_env.policies.names import POLICIES, make_policy

__all__ = [
    "POLICIES",
    "Filtered",
    "PolicyDriver",
    "act",
    "act_lanes",
    "allocate_memory",
    "broadcast_size",
    "check_parameters",
    "check_policy",
    "check_rules",
    "decide",
    "evaded",
    "heard",
    "joint_weights",
    "make_policy",
    "memory_size",
]
