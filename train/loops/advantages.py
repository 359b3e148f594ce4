"""This module computes generalized advantages (GAE, Schulman et al. 2016)."""

import torch


def advantages_of(
    rewards: torch.Tensor,
    values: torch.Tensor,
    ended: torch.Tensor,
    discount: float,
    gae_lambda: float,
) -> torch.Tensor:
    """Return generalized advantages (T, R).

    Args:
        rewards: (T, R) rewards; the last one of a truncated episode includes the discounted value
            of its last observation.
        values: (T + 1, R) values of the observations before the actions, and of those at the end.
        ended: (T, R) bool: the episode ended with the action.
        discount: For each action.
        gae_lambda: For each action.
    """
    goes_on = ~ended
    surprises = rewards + discount * values[1:] * goes_on - values[:-1]
    advantages, later = torch.empty_like(rewards), torch.zeros_like(rewards[0])
    for t in range(len(rewards) - 1, -1, -1):
        later = surprises[t] + discount * gae_lambda * (later * goes_on[t])
        advantages[t] = later
    return advantages
