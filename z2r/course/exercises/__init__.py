"""The practice of the course: a module for each notebook, whose checks take the learner's own answer."""
