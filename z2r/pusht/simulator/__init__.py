"""Where the shipped data came from: the environment in MuJoCo, the scripted expert, the recorder, and the replay.

The only place that needs MuJoCo and LeRobot. Nothing that reads a dataset imports it.
"""
