"""What can be wrong with a dataset: one module for each kind of check, put together in `z2r.auditing`."""
