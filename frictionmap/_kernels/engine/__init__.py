"""One driver for one mass and for structures: follow a motion, recognise its return, solve, measure.

| module | what is in it |
|---|---|
| `answers` | what the driver takes and gives: contact, moment, limits, cell |
| `motion` | the interface: what a kind of motion has to offer |
| `one_mass`, `many_masses` | the two that there are |
| `memory` | anchors remembered |
| `returns` | the recogniser of returns |
| `statistics` | what a motion that does not repeat does on average; when to try Newton's method |
| `march` | the driver |
| `measure` | stops, amplitude and share stuck of a periodic orbit, and its table of phases |
| `segment_table` | the table of phases of a steady state |
| `extremes`, `transforms`, `harmonics`, `works`, `rests`, `floquet`, `time_history` | what is read from it |
| `details`, `quantities` | those of them that a map was asked for |
| `coexistence` | what else a cell could end in |
| `window` | a part of a motion that does not repeat |
| `fill` | the cells of a map |
| `policies` | starts and thresholds that both kinds of motion share |
"""
