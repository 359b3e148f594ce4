"""This module computes the layers of a network in kernels: normalizer, tanh units, outputs."""

from hav_env.compiled import fixed, kernel
from hav_env.maths.elementary import exp
from hav_env.maths.geometry import clip


@kernel
def normalize(policy, inputs, lanes):
    """Normalize the inputs (I, W) in the first lanes."""
    for number in range(inputs.shape[0]):
        row = fixed(number)
        mean, scale, limit = policy.mean[row], policy.scale[row], policy.limit
        for k in range(lanes):
            inputs[row, k] = clip((inputs[row, k] - mean) * scale, -limit, limit)


@kernel
def propagate(policy, rows, lanes):
    """Compute the layers in the first lanes.

    Args:
        policy: A Network.
        rows: (K, W) The first rows are the inputs; the function overwrites the other rows.
        lanes: Number of lanes.

    Returns:
        The row of the first output; the second output is in the next row.
    """
    inputs, first, widest = 0, 0, 0
    for layer in range(1, policy.sizes.size):
        widest = max(widest, policy.sizes[layer])
    outputs, last = policy.sizes[0], policy.sizes.size - 1
    for layer in range(1, policy.sizes.size):
        num_inputs, num_outputs = policy.sizes[layer - 1], policy.sizes[layer]
        biases = first + num_inputs * num_outputs
        for number in range(num_outputs):
            output = fixed(outputs + number)
            _sum_up(policy, rows, lanes, inputs, output, num_inputs, first, biases + number)
            first += num_inputs
            if layer < last:
                for k in range(lanes):  # tanh
                    rows[output, k] = 1.0 - 2.0 / (1.0 + exp(2.0 * rows[output, k]))
        first += num_outputs
        inputs, outputs = outputs, policy.sizes[0] + (widest if layer % 2 == 1 else 0)
    return inputs


@kernel
def _sum_up(policy, rows, lanes, inputs, output, num_inputs, first, bias):
    """Compute one unit: its bias plus weights times inputs, in groups of four."""
    weights = policy.weights
    for k in range(lanes):
        rows[output, k] = weights[bias]
    for number in range(0, num_inputs - 3, 4):
        one, w = fixed(inputs + number), first + number
        for k in range(lanes):
            pair = weights[w] * rows[one, k] + weights[w + 1] * rows[one + 1, k]
            other = weights[w + 2] * rows[one + 2, k] + weights[w + 3] * rows[one + 3, k]
            rows[output, k] += pair + other
    for number in range(num_inputs - num_inputs % 4, num_inputs):
        one, w = fixed(inputs + number), first + number
        for k in range(lanes):
            rows[output, k] += weights[w] * rows[one, k]
