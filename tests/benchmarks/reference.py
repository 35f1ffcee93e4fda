"""The reference flow: what one writes without z2r. `LeRobotDataset`, a loop over its rows, `rr.log` for each.

python tests/benchmarks/reference.py inspect DATASET
python tests/benchmarks/reference.py replay FRAMES OUT.rrd
"""

import json
import math
import os
import sys

os.environ["HF_HUB_OFFLINE"] = "1"


def inspect(root: str) -> None:
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("reference/reference", root=root, video_backend="pyav")
    lengths: dict[int, int] = {}
    errors: dict[int, tuple[float, float]] = {}
    low, high = [math.inf] * 12, [-math.inf] * 12
    for i in range(len(dataset)):
        row = dataset[i]
        state, action = row["observation.state"].tolist(), row["action"].tolist()
        episode = int(row["episode_index"])
        _, _, x, y, tee_sin, tee_cos, target_x, target_y, target_sin, target_cos = state
        turn = math.atan2(tee_sin, tee_cos) - math.atan2(target_sin, target_cos)
        turn = (turn + math.pi) % (2 * math.pi) - math.pi
        errors[episode] = math.hypot(x - target_x, y - target_y), abs(turn)
        lengths[episode] = lengths.get(episode, 0) + 1
        for j, value in enumerate(state + action):
            low[j], high[j] = min(low[j], value), max(high[j], value)
    reached = [pos_err <= 0.03 and ang_err <= 0.2 for pos_err, ang_err in errors.values()]
    print(json.dumps({"episode_lengths": list(lengths.values()), "reached": reached}))


def replay(n_frames: int, path: str) -> None:
    import rerun as rr
    from layouts import random_frames

    state, action = random_frames(n_frames, seed=0)
    rr.init("reference")
    rr.save(path)
    for i in range(n_frames):
        pusher_x, pusher_y, x, y, sin_yaw, cos_yaw = state[i, :6].tolist()
        yaw = math.atan2(sin_yaw, cos_yaw)
        rr.set_time("frame", sequence=i)
        rr.set_time("sim_time", duration=i / 10)
        rr.log(
            "world/objects/tee",
            rr.Transform3D(
                translation=[x, y, 0.0152],
                quaternion=rr.Quaternion(xyzw=[0, 0, math.sin(yaw / 2), math.cos(yaw / 2)]),
            ),
        )
        rr.log("world/robot/pusher", rr.Transform3D(translation=[pusher_x, pusher_y, 0.02]))
        rr.log("policy/action", rr.Scalars(action[i]))
        rr.log("eval/pos_err", rr.Scalars(math.hypot(x, y)))
        rr.log("eval/ang_err", rr.Scalars(abs(yaw)))
        rr.log("eval/episode_index", rr.Scalars(0))


if __name__ == "__main__":
    if sys.argv[1] == "inspect":
        inspect(sys.argv[2])
    else:
        replay(int(sys.argv[2]), sys.argv[3])
