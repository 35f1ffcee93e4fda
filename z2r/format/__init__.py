"""What is on disk: a LeRobot v3 dataset, read fast and checked, whatever robot it is of.

Here stands all that knows the layout of the files, and nothing that knows what a column means. Imports: `z2r.errors`,
`z2r.arrays`.
"""
