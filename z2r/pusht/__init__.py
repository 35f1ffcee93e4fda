"""One task: PushT, a disc that shoves a T-shaped block onto a target, and all that only this task knows.

Its numbers, its bodies, its checks, what is read wrong in it, the simulator, and policies that learn it. Imports:
`z2r.reading` and below; who shows or audits datasets gets it handed down as a scene, and never imports it.
"""
