"""Parts of `tools/campaign`: random missions, real simulators, their own truth, figures."""
