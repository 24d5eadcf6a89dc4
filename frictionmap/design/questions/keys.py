"""Keys of the table [design] that several questions have."""

from ...files.key import DOF, Key, either, number, several, table, whole, with_unit, word

BAND = Key(
    "band",
    "range of frequencies of the load",
    several(either(number(above=0.0), with_unit("frequency")), 2, maxItems=2),
    example="[0.3, 2.2]",
    words="two frequency ratios > 0, increasing, or frequencies with units",
)
RESPONSE = Key(
    "response",
    "response to minimise: amplitude or first_harmonic of a mass, contact (the displacement in it) "
    "or transmitted_force",
    table(
        {
            "quantity": word("amplitude", "first_harmonic", "contact", "transmitted_force"),
            "mass": DOF,
            "contact": whole(least=1),
        }
    ),
    example='{ quantity = "amplitude", mass = 1 }',
    words="{ quantity, mass or contact }",
)
MU = Key("mu", "static-to-kinetic friction ratio", number(least=1.0), 1.0)
BETA = Key(
    "beta",
    "range of friction to search; for margin the friction of the working point",
    either(
        several(either(number(least=0.0), with_unit("force")), 2, maxItems=2),
        number(above=0.0),
        with_unit("force"),
    ),
    example="[0.02, 4.0]",
    words="two friction ratios, increasing, or one; or forces with units",
)

#: Optional keys of all questions about the largest response.
OF_PEAKS = (RESPONSE, MU, BETA)
