"""The course: how its notebooks are built, what they draw, and how they check an answer.

Of no use to who only reads a dataset, and imported by the notebooks and the command line alone. May import all else.
"""
