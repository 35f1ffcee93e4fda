"""The page that `z2r.report` writes: what goes into it, its HTML, its style and its script."""
