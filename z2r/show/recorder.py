"""How does a column get into a recording (.rrd)? Whole, with a row for every frame, never row by row."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Array, Floats, Ints

APPLICATION_ID = "seeing-like-a-robot"


class Recorder:
    """Collects columns. Frames of all episodes lie one after another on two timelines: `sim_time` and `frame`.

    Attributes
    ----------
    starts : ndarray, int64[n_episodes]
        The first frame of each episode.
    n_frames : int
        Of all episodes together.
    """

    def __init__(self, name: str, fps: float, lengths: Ints) -> None:
        self.stream = rr.RecordingStream(APPLICATION_ID, recording_id=name)
        # Not `save`: where the disk is full, rerun 0.41 may wait for ever, and leaves half a file.
        self._memory = self.stream.memory_recording()
        self.fps, self.starts, self.n_frames = fps, np.cumsum(lengths) - lengths, int(lengths.sum())

    def static(self, entity: str, *components: rr.AsComponents) -> None:
        """Send what is the same in all frames."""
        self.stream.log(entity, *components, static=True)

    def columns(self, entity: str, columns: rr.ComponentColumnList, frames: Ints | Floats | None = None) -> None:
        """Send a row for each of these frames, or for every one."""
        at = np.arange(self.n_frames) if frames is None else frames
        time = [rr.TimeColumn("sim_time", duration=at / self.fps), rr.TimeColumn("frame", sequence=at.astype(np.int64))]
        self.stream.send_columns(entity, indexes=time, columns=columns)

    def lines(self, entity: str, values: Array) -> None:
        """Send numbers, (n_frames, n_lines) or (n_frames,), as lines of which none goes on to the next episode."""
        self.columns(entity, rr.Scalars.columns(scalars=values))
        self.clear(entity, self.starts[1:])

    def clear(self, entity: str, frames: Ints) -> None:
        """End what is shown before each of these frames: half a frame earlier, so that the last one stays."""
        if len(frames):
            self.columns(entity, rr.Clear.columns(is_recursive=[False] * len(frames)), frames.astype(float) - 0.5)

    def close(self, blueprint: rrb.Blueprint) -> bytes:
        """Add the layout of the viewer, and return what is to be in the file."""
        self.stream.send_blueprint(blueprint)
        self.stream.flush()
        contents = self._memory.drain_as_bytes()
        self.stream.disconnect()
        return contents
