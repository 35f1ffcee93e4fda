"""What does a misreading cost a policy? Behaviour cloning on PushT: data, model, rollout, and the experiment.

The only place that needs torch. Nothing that reads a dataset imports it; what it measured ships beside it.
"""
