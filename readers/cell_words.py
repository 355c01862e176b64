"""Words in cells of consists as people write them: German, French and English words for those of a column.

Words of UIC 540, 544-1 and 545 and of brake sheets. In France P is V (voyageurs), and G is M (marchandises). A word is
here if it means one choice alone; those that may mean several are in `SEVERAL`.
"""

from __future__ import annotations

from readers.column_words import plain

_YES, _NO = ("ja", "oui"), ("nein", "non")
#: Words by column and choice.
CELL_WORDS: dict[str, dict[str, tuple[str, ...]]] = {
    "kind": {
        "wagon": (
            *("Wagen", "Güterwagen", "Waggon", "Kesselwagen", "wagon de marchandises", "freight car", "freight wagon"),
            *("hopper", "gondola", "boxcar", "tank car", "flatcar"),
        ),
        "locomotive": (
            *("Lokomotive", "Lok", "Ellok", "E-Lok", "Diesellok", "Tfz", "Triebfahrzeug", "loco", "engine"),
            *("engin moteur", "machine"),
        ),
        "coach": (
            *("Reisezugwagen", "Personenwagen", "Sitzwagen", "Speisewagen", "Steuerwagen", "voiture"),
            *("voiture voyageurs", "passenger car", "carriage"),
        ),
    },
    "position": {
        "P": ("V", "Personenzug", "voyageurs"),
        "G": ("M", "Güterzug", "marchandises"),
        "R": ("Rapid",),
        "R+Mg": ("RMg",),
    },
    "brake": {
        "pneumatic": ("Druckluft", "Druckluftbremse", "pneumatique", "air"),
        "none": ("keine", "ohne", "Leitungswagen", "aucun", "sans"),
    },
    "friction": {
        "cast-iron-p10": ("Grauguss P10", "P10", "fonte P10"),
        "cast-iron-p6": ("Grauguss P6", "P6", "fonte P6"),
        "pads": ("Bremsbeläge", "Scheibenbremse", "garnitures", "disques"),
        "constant": ("konstant", "constante"),
        "table": ("Tabelle",),
    },
    "coupler": {
        "screw": ("Schraubenkupplung", "attelage à vis"),
        "rigid": ("starr", "rigide"),
    },
    "valve": {"none": ("keines", "aucun", "ohne")},
    "accelerated_release": {"yes": _YES, "no": _NO},
    "direct_admission": {"yes": _YES, "no": _NO},
    "distributor": {"vacuum": ("Saugluft", "Saugluftbremse", "Vakuumbremse", "vide", "frein à vide")},
    "vigilance_penalty": {
        "emergency": ("Schnellbremsung", "freinage d'urgence"),
        "service": ("Vollbremsung", "freinage de service"),
    },
    "weighing": {"continuous": ("stufenlos", "continu"), "lever": ("Hebel", "zweistufig")},
}
#: Words that mean no choice, or may mean several, by column, each with its remedy.
SEVERAL: dict[str, dict[str, str]] = {
    "kind": {
        **dict.fromkeys(("car", "fahrzeug", "vehicule", "vehicle"), "Write wagon, coach or locomotive."),
        **dict.fromkeys(
            ("triebwagen", "automotrice", "motrice", "railcar"), "Write coach, and state its motors and its brake."
        ),
        **dict.fromkeys(
            ("", "summe", "gesamt", "total", "totals", "somme"), "Write the kind, or remove a row of totals or units."
        ),
    },
    "position": {
        **dict.fromkeys(("p_e", "r_e", "p_e160", "r_e160"), "Write P or R with its brake weight, and dynamic_force."),
        "p_mg": "Magnets have a position of their own: R+Mg.",
    },
    "friction": {
        **dict.fromkeys(("grauguss", "gg", "fonte", "cast_iron"), "Write cast-iron-p6 or cast-iron-p10."),
        **dict.fromkeys(("k", "k_sohle", "k_block", "semelle_k"), "Write composite or composite-k."),
        **dict.fromkeys(("ll", "ll_sohle", "ll_block"), "No law of it is published: state one with friction = table."),
    },
}


def spellings(column: str, words: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    """Return the further spellings of a column's words, as `plain` returns them, each with its word."""
    of_column = CELL_WORDS.get(column, {})
    return tuple((plain(spelling), word) for word in words for spelling in of_column.get(word, ()))
