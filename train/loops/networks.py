"""This module has the networks of the own loops in PyTorch: plain, or with pooled neighbours."""

import itertools
from collections.abc import Sequence
from typing import Literal, NamedTuple

import torch
from torch import nn

Kind = Literal["plain", "pooled"]
_LEAST = -1.0  # of tanh: the maximum over no neighbour begins with it


class Row(NamedTuple):
    """Layout of an observation: the HAV's own columns, then K neighbours of C columns each."""

    own: int
    """Number of the HAV's own columns."""
    neighbors: int
    """Number K of neighbours."""
    each: int
    """Number C of columns of a neighbour; the first one, ``present``, is 1 or 0."""


def linear(inputs: int, outputs: int, gain: float = 2**0.5) -> nn.Linear:
    """Return a layer with orthogonal weights and biases of 0."""
    layer = nn.Linear(inputs, outputs)
    nn.init.orthogonal_(layer.weight, gain)
    nn.init.zeros_(layer.bias)
    return layer


def hidden_layers(sizes: Sequence[int]) -> list[nn.Module]:
    """Return layers with tanh units, from ``sizes[0]`` inputs on."""
    pairs = itertools.pairwise(sizes)
    return [part for pair in pairs for part in (linear(*pair), nn.Tanh())]


class Pool(nn.Module):
    """Encode every neighbour by the same layers; return own columns, means and maxima.

    Absent neighbours have no effect, and neither has the order of neighbours.
    """

    def __init__(self, row: Row, units: Sequence[int]) -> None:
        """Build the layers.

        Args:
            row: Layout of the observation.
            units: Units of each layer of the encoder.
        """
        super().__init__()
        self.row = row
        self.encoder = nn.Sequential(*hidden_layers([row.each, *units]))
        self.outputs = row.own + 2 * units[-1]

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """Return (B, own + 2 E) of normalized observations (B, D), for any number of neighbours."""
        own, neighbors = rows[:, : self.row.own], rows[:, self.row.own :]
        neighbors = neighbors.unflatten(1, (-1, self.row.each))
        present = neighbors[..., :1]
        encoded = self.encoder(neighbors)
        count = present.sum(1)
        mean = (encoded * present).sum(1) / count.clamp(min=1.0)
        most = ((encoded - _LEAST) * present + _LEAST).amax(1) * (count > 0.0)
        return torch.cat([own, mean, most], 1)


class Body(nn.Module):
    """Hidden layers of an actor or a critic, behind the pool if there is one."""

    def __init__(self, kind: Kind, row: Row, encoder: Sequence[int], layers: Sequence[int]) -> None:
        """Build the layers.

        Args:
            kind: Whether neighbours are pooled. Without neighbours there is nothing to pool.
            row: Layout of the observation.
            encoder: Units of each layer of the encoder; a plain network has none.
            layers: Units of each hidden layer.
        """
        super().__init__()
        pooled = kind == "pooled" and row.neighbors > 0
        self.pool = Pool(row, encoder) if pooled else None
        inputs = self.pool.outputs if self.pool else row.own + row.neighbors * row.each
        self.hidden = nn.Sequential(*hidden_layers([inputs, *layers]))
        self.outputs = layers[-1]

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """Return the last hidden layer (B, H) of normalized observations (B, D)."""
        return self.hidden(rows if self.pool is None else self.pool(rows))


class Actor(nn.Module):
    """A normal distribution of actions, whose noise is independent or held for some actions.

    Held noise is a linear function of the last hidden layer (gSDE, Raffin et al. 2021).
    """

    def __init__(self, body: Body, deviation: float, held: bool) -> None:
        """Put outputs on a body.

        Args:
            body: The hidden layers.
            deviation: Initial standard deviation of actions, or with held noise of its weights.
            held: Whether the noise is held.
        """
        super().__init__()
        self.body, self.output = body, linear(body.outputs, 2, 0.01)
        shape = (body.outputs, 2) if held else (2,)
        logarithm = torch.full(shape, float(torch.tensor(deviation).log()))
        self.log_deviation = nn.Parameter(logarithm)
        self.held = held
        self.weights = torch.zeros(0)  # of held noise, (B, H, 2)

    def draw(self, rows: int) -> None:
        """Draw new weights of held noise for a number of rows B."""
        if self.held:
            self.weights = torch.randn(rows, *self.log_deviation.shape) * self.log_deviation.exp()

    def distribution(self, rows: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return means and standard deviations (B, 2) of actions."""
        latent = self.body(rows)
        return self.output(latent), self._deviation(latent)

    def act(self, rows: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return drawn actions (B, 2), and the logarithms of their densities (B,)."""
        latent = self.body(rows)
        mean, deviation = self.output(latent), self._deviation(latent)
        if self.held:
            actions = mean + torch.einsum("bh,bha->ba", latent, self.weights)
        else:
            actions = mean + deviation * torch.randn_like(mean)
        return actions, log_density(actions, mean, deviation)

    def _deviation(self, latent: torch.Tensor) -> torch.Tensor:
        if not self.held:
            return self.log_deviation.exp().expand(len(latent), 2)
        # the deviations of weights do not train the layers
        return (latent.detach().square() @ (2.0 * self.log_deviation).exp() + 1e-6).sqrt()


def log_density(actions: torch.Tensor, mean: torch.Tensor, deviation: torch.Tensor) -> torch.Tensor:
    """Return the logarithms of the normal densities of actions (B, 2), up to a constant: (B,)."""
    return (-0.5 * ((actions - mean) / deviation).square() - deviation.log()).sum(1)


def linear_layers(parts: nn.Module) -> list[nn.Linear]:
    """Return the linear layers of a sequence."""
    return [part for part in parts.modules() if isinstance(part, nn.Linear)]
