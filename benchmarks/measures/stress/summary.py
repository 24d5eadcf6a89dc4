"""Results of the groups: numbers for the JSON file, tables for the terminal."""

from frictionmap import regimes

from ...report.record import table
from .group import STATUS_NAMES, Group

#: Lines printed of a group's list; the JSON has all.
SHOWN = 12


def summary(group: Group) -> dict:
    left = sorted(16.0 - row["lost"] for row in group.answers)
    return {
        "cells": group.cells,
        "resolved": group.statuses[regimes.RESOLVED],
        "other statuses": {
            STATUS_NAMES[s]: n for s, n in sorted(group.statuses.items()) if s != regimes.RESOLVED
        },
        "numbers compared": len(left),
        "digits left, least": left[0] if left else None,
        "digits left, median": left[len(left) // 2] if left else None,
        "digits explained by condition, most": max(
            (row["explained"] for row in group.answers), default=0.0
        ),
        "digits lost beyond, most": max(
            (max(row["lost"] - row["explained"], 0.0) for row in group.answers), default=0.0
        ),
        "more than allowed": len(group.beyond),
        "wrong regimes": len(group.wrong),
        "wrong regimes at rounding": group.at_rounding,
        "no stops, but more than two turns a cycle": group.many_turns,
        "stops counted": group.counted,
        "wrong stop counts": len(group.miscounted),
        "wrong stop counts at rounding": group.miscounts_at_rounding,
        "wrong stop counts with a status": group.flagged_miscounts,
        "inconsistent": len(group.inconsistent),
        "trouble": len(group.trouble),
        "slowest cell [s]": group.slowest,
        "seconds": group.seconds,
        "list": {
            "digits": [
                {name: row[name] if name == "what" else round(row[name], 1) for name in row if name != "k"}
                for row in group.beyond
            ],
            "regimes": group.wrong,
            "stops": group.miscounted,
            "inconsistent": group.inconsistent,
            "trouble": group.trouble,
        },
    }  # fmt: skip


def print_summaries(content: dict) -> None:
    header = (
        "group", "cells", "resolved", "left", "median", "beyond", "> 2", "regimes", "(round.)", "counted",
        "stops", "(round.)", "(status)", "incons.", "trouble", "slowest", "s",
    )  # fmt: skip
    keys = (
        "cells", "resolved", "digits left, least", "digits left, median", "digits lost beyond, most",
        "more than allowed", "wrong regimes", "wrong regimes at rounding", "stops counted",
        "wrong stop counts", "wrong stop counts at rounding", "wrong stop counts with a status",
        "inconsistent", "trouble", "slowest cell [s]", "seconds",
    )  # fmt: skip
    table(
        header, [(name, *("-" if row[k] is None else row[k] for k in keys)) for name, row in content.items()]
    )
    for name, row in content.items():
        if row["other statuses"]:
            print(f"{name}: {', '.join(f'{n} {s}' for s, n in row['other statuses'].items())}")
    for name, row in content.items():
        lines = [
            f"{r['what']}: {r['lost']:.1f} digits lost, {r['explained']:.1f} explained"
            for r in row["list"]["digits"]
        ]
        for kind in ("regimes", "stops", "inconsistent", "trouble"):
            lines += [f"{kind}: {line}" for line in row["list"][kind]]
        for line in lines[:SHOWN]:
            print(f"{name} | {line}")
        if len(lines) > SHOWN:
            print(f"{name} | ... and {len(lines) - SHOWN} more in stress.json")
