"""The datasets that ship with the package, written by `z2r record`.

- ``standin``: six demonstrations, all of which reached the target.
- ``messy``: what people really record. Noise is twice as large, episodes end after 120 frames, and the seeds were
  chosen among the first thousand: some time out, some are very short, and one times out in tolerance without having
  held there, so that a reading calls it reached and the simulator does not call it a success. With the usual limit of
  300 frames, none of the first thousand seeds ends like that.

Next to each is a verdict: what the simulator said of every episode, the command that recorded it, and the stack that
it ran on (`z2r.pusht.verdict`).
"""

from pathlib import Path

STANDIN = Path(__file__).parent / "standin"
MESSY = Path(__file__).parent / "messy"
SHIPPED = {"standin": STANDIN, "messy": MESSY}
REPLAY_STILL = Path(__file__).parent / "replay_still.png"
