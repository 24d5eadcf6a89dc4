"""The map of the paper: `python paper/figures.py` writes it beside it; the other figure is of a benchmark."""

from pathlib import Path

import frictionmap as fm

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


def main() -> None:
    """Compute and draw the map."""
    config = fm.load_config(ROOT / "configs" / "fig-3-12.toml")
    ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    (axes, *_) = fm.plot_regimes(ds, size="170mm", caption=False)
    axes.figure.savefig(HERE / "map.png", dpi=150)


if __name__ == "__main__":
    main()
