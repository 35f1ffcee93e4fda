"""What is wrong with a dataset? Here stand the checks that any robot's dataset is asked, and the one pass that asks.

A check is declared where it is answered: in `structure`, `index` and `values`, in the order in which findings come.
Imports: `z2r.reading` and below.
"""
