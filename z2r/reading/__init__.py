"""What it means: readings, which say what named columns mean, and what follows from that, for any robot.

Here stands what needs a meaning and no task: poses, goals, what was reached, and how to get it wrong. Imports:
`z2r.format` and below.
"""
