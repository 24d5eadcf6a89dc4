"""Rows of the counters of a motion, one number per contact."""

STOPS, TURNS, STUCK, SLIPS, REVERSALS, LAST_SENSE = 0, 1, 2, 3, 4, 5
MOVED = 6  # 0: at rest; 1, 2: slid up, down; 3: both
NEAREST_STOP = 7  # largest share that friction has of the force that would hold a contact at a turn
FIRST_SENSE = 8  # of the slips of an elastic contact; 0 before the first
RELEASE_ORDER = 9  # 1 where releasing all overloaded contacts at once would leave it in another state
STOPS_ERROR, STUCK_ERROR = 10, 11  # standard errors per period of the load, of averages; else 0
CROSSINGS = 12  # of break points of a friction law
COUNT_ROWS = 13  # after them the time in every segment of a friction law
