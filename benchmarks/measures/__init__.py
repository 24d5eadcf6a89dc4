"""What is measured: one module for each sub-command, with `run(quick, results)`; see the package above."""
