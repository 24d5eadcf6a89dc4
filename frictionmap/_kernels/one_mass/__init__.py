"""One mass: scan step, events, return map, sliding orbit."""
