"""This module names the rewards that environments and training scripts take by name."""

from hav_env.mdp.reward import Reward, reward_terms
from hav_env.mdp.site_reward import SiteReward
from hav_env.models.names import Registry

REWARDS = Registry(
    "reward",
    "hav_env.rewards",
    reward_terms.table.__contains__,
    "register it with reward_terms.register",
    {"default": Reward, "site": SiteReward},
)
