"""Any structure: scan step, events, return map, sliding orbit."""
