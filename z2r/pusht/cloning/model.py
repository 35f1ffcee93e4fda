"""How does a policy learn to do as was done? Behaviour cloning: a small network, fitted to examples by least squares.

It predicts the next `CHUNK` actions at once. What is played is a running mean of its weights, and the step size falls
to nothing: both average out the noise that the demonstrations have on their actions.
"""

import copy
from dataclasses import dataclass

from z2r.arrays import Array, Floats
from z2r.errors import MissingExtraError
from z2r.pusht.cloning.data import CHUNK, MIRROR, MIRROR_ACTION, Examples, Scale, scale_of

try:
    import torch
    from torch import Tensor, nn
    from torch.nn import functional
except ModuleNotFoundError as error:
    raise MissingExtraError(
        f"training needs {error.name}, which is not installed. In a clone of the course: pip install '.[train]'"
    ) from error

WIDTH, DEPTH = 512, 3
BATCH = 256
RATE, DECAY = 3e-3, 1e-2  # of AdamW
WARM_UP = 0.05  # of all steps, until the step size is RATE
HALF = torch.cpu._is_avx512_bf16_supported()  # products in bfloat16, where the processor has it: three times as quick
MEMORY = 0.999  # of the mean of the weights: about the last thousand steps


class Residual(nn.Module):
    """One layer, added to what it was given."""

    def __init__(self) -> None:
        super().__init__()
        self.norm, self.linear = nn.LayerNorm(WIDTH), nn.Linear(WIDTH, WIDTH)

    def forward(self, x: Tensor) -> Tensor:
        """Return the sum, (B, WIDTH)."""
        return x + functional.gelu(self.linear(self.norm(x)))


def network(n_inputs: int) -> nn.Sequential:
    """Return what maps (B, n_inputs) to (B, CHUNK, 2), not yet trained."""
    layers = [Residual() for _ in range(DEPTH)]
    last = nn.Linear(WIDTH, CHUNK * 2)
    return nn.Sequential(nn.Linear(n_inputs, WIDTH), *layers, nn.LayerNorm(WIDTH), last, nn.Unflatten(1, (CHUNK, 2)))


@dataclass(frozen=True)
class Policy:
    """A network, and the scale of its inputs and actions."""

    network: nn.Module
    scale: Scale

    def __call__(self, inputs: Floats) -> Floats:
        """Say what to do: from float64[n, 13], as of `z2r.pusht.cloning.data.inputs`, float64[n, CHUNK, 2] [m/s]."""
        with torch.inference_mode():
            actions: Floats = self.network(_tensor(inputs / self.scale.inputs)).double().numpy()
        return actions * self.scale.action


def train(examples: Examples, steps: int, seed: int, scale: Scale | None = None, *, with_mirror: bool = True) -> Policy:
    """Fit a policy to examples.

    Parameters
    ----------
    examples : Examples
        From `read_examples`.
    steps : int
        How many batches to learn from.
    seed : int
        Draws the first weights and the batches.
    scale : Scale, optional
        That of the examples unless given.
    with_mirror : bool, optional
        Whether each example is shown mirrored half of the time.
    """
    scale = scale or scale_of(examples)
    x, there = _tensor(examples.inputs / scale.inputs), _tensor(examples.there)[..., None]
    y = _tensor(examples.actions / scale.action)
    torch.manual_seed(seed)
    learner = network(x.shape[1])
    mean = copy.deepcopy(learner)
    optimizer = torch.optim.AdamW(learner.parameters(), RATE, weight_decay=DECAY, fused=True)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps, pct_start=WARM_UP)
    for step in range(steps):
        rows = torch.randint(len(x), (BATCH,))
        mirrored = torch.rand(BATCH, 1) < (0.5 if with_mirror else 0.0)
        batch = torch.where(mirrored, x[rows] * _tensor(MIRROR), x[rows])  # (B, 13)
        wanted = torch.where(mirrored[..., None], y[rows] * _tensor(MIRROR_ACTION), y[rows])  # (B, CHUNK, 2)
        with torch.autocast("cpu", torch.bfloat16, enabled=HALF):
            predicted = learner(batch).float()  # (B, CHUNK, 2)
        loss = ((predicted - wanted) ** 2 * there[rows]).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
        _follow(mean, learner, min(MEMORY, (1 + step) / (10 + step)))
    return Policy(mean, scale)


def use_one_thread() -> None:
    """Let this process compute on one core."""
    torch.set_num_threads(1)


@torch.no_grad()
def _follow(mean: nn.Module, learner: nn.Module, memory: float) -> None:
    torch._foreach_lerp_(list(mean.parameters()), list(learner.parameters()), 1 - memory)


def _tensor(values: Array) -> Tensor:
    return torch.as_tensor(values, dtype=torch.float32)
