"""Figures of the paper: `python paper/figures.py` writes them beside it."""

import shutil
from pathlib import Path

import frictionmap as fm

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


def main() -> None:
    """Draw the map, and take the figure of the benchmark as it was measured."""
    config = fm.load_config(ROOT / "configs" / "fig-3-12.toml")
    ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    (axes, *_) = fm.plot_regimes(ds, size="170mm", caption=False)
    axes.figure.savefig(HERE / "map.png", dpi=150)
    shutil.copy(ROOT / "benchmarks" / "results" / "accuracy.png", HERE / "accuracy.png")


if __name__ == "__main__":
    main()
