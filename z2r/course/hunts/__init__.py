"""The hunts of the course: a module for each, which draws datasets from a seed and scores what the learner wrote."""
