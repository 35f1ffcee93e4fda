"""What can be wrong with a dataset: one module for each kind of check, put together in `z2r.audits.audit`."""

# What each check asks, in the order in which they are made. The names are stable: scripts may rely on them.
CHECKS: dict[str, str] = {
    # structure
    "info": "meta/info.json is there, and every field in it is what it should be",
    "version": "the dataset is of format v3",
    "episodes-file": "every shard of the episode metadata is there and can be read",
    "tasks-file": "meta/tasks.parquet is there, and numbers its tasks 0, 1, 2 ...",
    "stats-file": "meta/stats.json is there and can be read",
    "data-file": "every data file that the index names is there and can be read",
    "video-file": "every video that the index names is there",
    "file-order": "files sorted by name are sorted by number, as LeRobot reads them",
    "orphan-file": "there is no parquet file or video that nothing names",
    "columns": "every feature has a column, and every column is a feature",
    "column-type": "every column has the type and the width that the schema says",
    "totals": "the totals in meta/info.json are those that are counted",
    "splits": "every split is a range of episodes that exist",
    # index
    "episode-order": "episodes are numbered 0, 1, 2 ... in order",
    "range-length": "every episode has frames, and as many as its range",
    "range-overlap": "no frame belongs to two episodes",
    "range-gap": "every frame belongs to an episode",
    "file-pointer": "every episode is in the data file that the index names",
    "file-rows": "every data file has as many rows as its episodes have frames",
    "index-column": "`index` counts all frames without a break",
    "frame-column": "`frame_index` starts at 0 in every episode and counts on",
    "episode-column": "`episode_index` changes where the index says that an episode ends",
    "timestamp": "`timestamp` is frame_index / fps",
    "task-index": "every `task_index` is a task",
    # values
    "finite": "there is no NaN, no infinity, and no gap",
    "unit-circle": "sin² + cos² is 1 for every angle that is stored as (sin, cos)",
    "jump": "no value leaps away and back, many times further than it moves elsewhere",
    "frozen": "no sensor stands still for an episode while it moves in the others",
    "twin": "no demonstration is there twice",
    "stats": "the stored statistics are those of the data",
    # reading
    "action-range": "no action is beyond what the robot can do",
    "overlap": "solid bodies stay apart",
    "action-motion": "the action moves the pusher the way it says, at once and at the right speed",
    "leap": "nothing leaps inside an episode, and something does where one ends",
    "yaw-error": "no error in yaw is more than half a turn",
    "final-offset": "episodes do not all miss the target in the same way",
    "decisive-frame": "an episode that comes into tolerance mostly stays there",
    "verdict": "the reading agrees with the simulator's verdict, where there is one",
}
