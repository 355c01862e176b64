"""German, French and further English names of columns and entries, one table for all readers.

The words are those of UIC 530, 540 and 544-1, of DIN EN 13803, 14531-1 and 15663, and of data sheets. Only words of the
same quantity are here. A brake sheet's Bremsart is the position of the brake, and its Gewicht the mass with the load.
Gefälle and pente are positive downwards. Lines have a curvature and not a radius. Lines and tracks have a factor on the
friction and not a Reibwert. Kilometrierung and point kilométrique are in kilometres, and columns without a unit in
metres. Words in cells: `cell_words.py`.
"""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from readers.text import quoted

#: Likeness of names from which a message suggests one: below it are other words, such as valve for axle.
ALIKE = 0.8
_DEVICES = {
    "buffer": (("Puffer",), ("tampon",)),
    "draw": (("Zugeinrichtung",), ("organe de traction",)),
    "tension": (("Zug",), ("traction",)),
    "compression": (("Druck",), ("compression",)),
}
_CURVES = {
    "travel": (("Weg", "Federweg"), ("course",)),
    "loading": (("Belastung",), ("charge",)),
    "unloading": (("Entlastung",), ("décharge",)),
    "damping": (("Dämpfung",), ("amortissement",)),
    "preload": (("Vorspannkraft",), ("précontrainte",)),
    "stroke": (("Hub",), ("course maximale",)),
}
#: Words of the kind of a vehicle, and of its name beside another word of the kind.
KIND_OR_NAME = (("Fahrzeug", "Fahrzeugtyp", "Wagentyp", "Typ"), ("véhicule",), ("vehicle",))
Words = tuple[tuple[str, ...], ...]
#: Words by name of the column: German, French, English.
COLUMN_WORDS: dict[str, Words] = {
    # Lines and tracks
    "time": (("Zeit",), ("temps",)),
    "speed": (("Geschwindigkeit",), ("vitesse",)),
    "distance": (("Weg", "Laufweg", "Wegstrecke"), ("distance parcourue", "abscisse", "abscisse curviligne")),
    "curvature": (("Krümmung", "Gleiskrümmung", "Bogenkrümmung"), ("courbure",)),
    "cant": (("Überhöhung", "Gleisüberhöhung"), ("dévers",)),
    "gradient": (("Neigung", "Längsneigung", "Steigung"), ("déclivité", "rampe")),
    "gauge_widening": (("Spurerweiterung",), ("surécartement",)),
    "left_lateral": (("linke Schiene seitlich",), ("rail gauche latéral",)),
    "left_vertical": (("linke Schiene vertikal",), ("rail gauche vertical",)),
    "right_lateral": (("rechte Schiene seitlich",), ("rail droit latéral",)),
    "right_vertical": (("rechte Schiene vertikal",), ("rail droit vertical",)),
    "left_friction": (("Reibungsfaktor links",), ("facteur de frottement gauche",)),
    "right_friction": (("Reibungsfaktor rechts",), ("facteur de frottement droit",)),
    "type": (("Typ", "Elementtyp"), ("type d'élément",)),
    "radius": (("Halbmesser", "Bogenhalbmesser", "Bogenradius"), ("rayon", "rayon de courbe")),
    "side": (("Seite",), ("côté",)),
    "chainage": (("Station", "Stationierung"), ("abscisse",)),
    "height": (("Höhe",), ("altitude", "hauteur")),
    "easting": (("Rechtswert", "Ostwert"), ("coordonnée est",)),
    "northing": (("Hochwert", "Nordwert"), ("coordonnée nord",)),
    "latitude": (("Breitengrad", "geographische Breite"), ()),
    "longitude": (("Längengrad", "geographische Länge"), ()),
    "lateral": (("seitlich",), ("latéral",)),
    "left": (("links",), ("gauche",)),
    "right": (("rechts",), ("droite",)),
    # Vehicles
    "kind": (
        ("Fahrzeugart", "Art", "Wagenart", *KIND_OR_NAME[0]),
        ("type de véhicule", "nature", *KIND_OR_NAME[1]),
        ("vehicle type", "car type", "type", *KIND_OR_NAME[2]),
    ),
    "name": (
        ("Bezeichnung", "Wagennummer", "Wagen-Nr", "Fahrzeugnummer", "Fahrzeug-Nr"),
        ("nom", "désignation", "numéro de wagon", "numéro du véhicule"),
        ("vehicle number", "car number", "wagon number"),
    ),
    "count": (("Anzahl", "Anzahl Fahrzeuge", "Stückzahl"), ("nombre", "nombre de véhicules"), ("quantity",)),
    "axles": (
        ("Achszahl", "Anzahl Radsätze", "Achsen", "Anzahl Achsen"),
        ("nombre d'essieux", "essieux"),
        ("axle count", "number of axles"),
    ),
    "number": (("Nr", "lfd. Nr", "laufende Nummer", "Reihung"), ("n°", "numéro", "rang"), ("no", "pos")),
    "remark": (("Bemerkung", "Bemerkungen"), ("remarque", "observations"), ("remarks", "comment", "comments", "note")),
    "class": (("Gattung", "Gattungszeichen", "Baureihe"), ("série",)),
    "train_type": (("Zugart",), ("type de train",)),
    "top_speed": (("Höchstgeschwindigkeit", "vmax"), ("vitesse maximale",), ("maximum speed", "max speed")),
    "tare": (
        ("Eigengewicht", "Eigenmasse", "Leermasse", "Leergewicht", "Tara"),
        ("masse à vide",),
        ("tare weight", "empty weight"),
    ),
    "load": (("Ladung", "Zuladung", "Lademasse", "Ladegewicht"), ("charge", "chargement"), ("lading",)),
    "mass": (
        ("Masse", "Gesamtmasse", "Gesamtgewicht", "Gewicht"),
        ("masse", "masse totale", "poids total", "poids"),
        ("weight", "gross weight", "total weight", "gross mass", "gross rail load"),
    ),
    "length": (
        ("Länge", "Länge über Puffer", "Länge üP", "LüP"),
        ("longueur", "longueur hors tampons"),
        ("length over buffers", "length over couplers"),
    ),
    "rotating": (("Zuschlag rotierende Massen",), ("majoration masses tournantes",)),
    "rotating_mass": (("rotierende Masse",), ("masse tournante",)),
    "resistance_a": (("Fahrwiderstand a",), ("résistance à l'avancement a",)),
    "resistance_b": (("Fahrwiderstand b",), ("résistance à l'avancement b",)),
    "resistance_c": (("Fahrwiderstand c",), ("résistance à l'avancement c",)),
    "wheelset_mass": (("Radsatzmasse",), ("masse de l'essieu", "masse d'un essieu")),
    "bogie_frame_mass": (("Drehgestellmasse ohne Radsätze",), ("masse du bogie sans essieux",)),
    "wheel_diameter": (("Raddurchmesser", "Laufkreisdurchmesser"), ("diamètre de roue", "diamètre des roues")),
    "pivot_distance": (("Drehzapfenabstand",), ("entraxe des pivots", "distance entre pivots")),
    "wheel_base": (("Achsstand im Drehgestell", "Drehgestellachsstand"), ("empattement du bogie",)),
    "coupler_height": (("Kupplungshöhe",), ("hauteur d'attelage",)),
    # Brakes
    "lambda": (
        ("Bremshundertstel", "Brh"),
        ("pourcentage de freinage", "pourcentage de masse freinée"),
        ("brake weight percentage", "braked weight percentage"),
    ),
    "brake_weight": (("Bremsgewicht",), ("masse freinée", "poids-frein"), ("braked weight", "braked mass")),
    "net_braking_ratio": ((), (), ("NBR", "braking ratio")),
    "deceleration": (("Verzögerung", "Bremsverzögerung"), ("décélération",)),
    "brake_force": (("Bremskraft",), ("effort de freinage", "force de freinage")),
    "shoe_force": (("Gesamtklotzkraft",), ("effort total des sabots",)),
    "shoes": (("Anzahl Bremsklötze", "Bremsklötze"), ("nombre de sabots", "sabots")),
    "cylinder_diameter": (
        ("Bremszylinderdurchmesser", "Zylinderdurchmesser"),
        ("diamètre du cylindre", "diamètre du cylindre de frein"),
    ),
    "cylinders": (("Anzahl Bremszylinder",), ("nombre de cylindres", "nombre de cylindres de frein")),
    "rigging_ratio": (("Gestängeübersetzung",), ("rapport de timonerie",)),
    "rigging_efficiency": (("Gestängewirkungsgrad",), ("rendement de timonerie", "rendement de la timonerie")),
    "return_force": (("Rückstellkraft",), ("effort de rappel",)),
    "friction": (("Reibungsgesetz",), ("loi de frottement",)),
    "friction_value": (("Reibwert", "Reibungszahl", "Reibbeiwert"), ("coefficient de frottement",)),
    "friction_table": (("Reibwerttabelle",), ("table de frottement",)),
    "full_pressure": (
        ("höchster Bremszylinderdruck", "Bremszylinderhöchstdruck"),
        ("pression maximale au cylindre",),
    ),
    "fill_time": (("Füllzeit", "Bremszylinderfüllzeit"), ("temps de remplissage",)),
    "release_time": (("Lösezeit", "Bremszylinderlösezeit"), ("temps de desserrage",)),
    "auxiliary": (("Hilfsluftbehälter",), ("réservoir auxiliaire",)),
    "cylinder": (("Bremszylindervolumen",), ("volume du cylindre", "volume des cylindres")),
    "vacuum": (("Unterdruck", "Luftleere"), ("dépression", "vide")),
    "exhauster": (("Saugleistung Luftsauger",), ("débit du ventilateur à vide",)),
    "ejector": (("Saugleistung Ejektor",), ("débit de l'éjecteur",)),
    "direct_admission": (("Schnellbremsventil am Fahrzeug",), ("admission directe",)),
    "pipe_diameter": (("Durchmesser Hauptluftleitung",), ("diamètre conduite générale",)),
    "brake": (("Bremsbauart", "Bauart der Bremse"), ("type de frein",), ("brake type",)),
    "distributor": (("Steuerventil",), ("distributeur",)),
    "position": (
        ("Bremsstellung", "Bremsart", "Br-Art"),
        ("régime de freinage", "régime", "régime de frein"),
        ("brake position", "brake regime"),
    ),
    "weighing": (("Lastabbremsung",), ()),
    "valve": (("Führerbremsventil",), ("robinet de mécanicien",)),
    "handle": (("Bauart Führerbremsventil",), ("type de robinet de mécanicien",)),
    "dead_time": (("Totzeit",), ("temps mort",)),
    "dynamic_force": (("elektrische Bremskraft",), ("effort de freinage électrique",)),
    "dynamic_power": (("elektrische Bremsleistung",), ("puissance de freinage électrique",)),
    "traction_force": (("Zugkraft", "Anfahrzugkraft"), ("effort de traction",)),
    "traction_power": (("Antriebsleistung",), ("puissance de traction",)),
    "traction_table": (("Zugkraftkennlinie",), ("courbe d'effort de traction",)),
    "magnetic_attraction": (("Haftkraft der Magnete", "Haftkraft", "Magnetkraft"), ("force d'attraction des patins",)),
    "eddy_force": (("Wirbelstrombremskraft",), ("effort du frein à courants de Foucault",)),
    "wheel_mass": (("Radmasse",), ("masse de roue",)),
    "wheels": (("Anzahl gebremster Räder",), ("nombre de roues freinées",)),
    "disc_mass": (("Bremsscheibenmasse",), ("masse du disque",)),
    "discs": (("Anzahl Bremsscheiben",), ("nombre de disques",)),
    "protection": (("Gleitschutz",), ("antienrayeur", "anti-enrayeur"), ("wheel slide protection", "WSP")),
    "encoder_teeth": (("Zähnezahl Polrad",), ("nombre de dents du codeur",)),
    "vent_time": (("Entlüftungszeit",), ("temps de vidange",)),
    "sample_time": (("Abtastzeit",), ("période d'échantillonnage",)),
    "parking_force": (("Feststellbremskraft",), ("effort de frein de stationnement",)),
    "main_reservoir": (("Hauptluftbehälter",), ("réservoir principal",)),
    "compressor": (
        ("Luftpresser", "Liefermenge des Luftpressers", "Liefermenge des Kompressors"),
        ("compresseur", "débit du compresseur"),
        ("air compressor",),
    ),
    "cut_in": (("Einschaltdruck",), ("pression d'enclenchement",)),
    "cut_out": (("Ausschaltdruck",), ("pression de déclenchement",)),
    "start_pressure": (("Anfangsdruck Hauptluftbehälter",), ("pression initiale du réservoir principal",)),
    "direct_pressure": (
        ("Druck der Zusatzbremse", "Druck der direkten Bremse"),
        ("pression du frein direct",),
        ("independent brake pressure",),
    ),
    "direct_fill_time": (("Füllzeit der Zusatzbremse",), ("temps de remplissage du frein direct",)),
    "direct_release_time": (("Lösezeit der Zusatzbremse",), ("temps de desserrage du frein direct",)),
    "vigilance_time": (
        ("Sifa-Zeit",),
        ("temporisation VACMA", "temporisation de veille automatique"),
        ("alerter time",),
    ),
    "warning_time": (("Sifa-Warnzeit",), ("temps d'alerte VACMA",)),
    # Couplers
    "coupler": (("Kupplung",), ("attelage",)),
    "coupler_stiffness": (("Kupplungssteifigkeit",), ("raideur d'attelage",)),
    "coupler_preload": (("Kupplungsvorspannung",), ("précontrainte d'attelage",)),
    "coupler_slack": (("Kupplungsspiel",), ("jeu d'attelage",)),
    "coupler_damping": (("Kupplungsdämpfung",), ("amortissement d'attelage",)),
    "coupler_strength": (("Kupplungsfestigkeit",), ("résistance d'attelage",)),
    "slack": (("Spiel",), ("jeu",)),
    "strength": (("Festigkeit",), ("résistance",)),
    "sticking_stiffness": (("Haftsteifigkeit",), ("raideur d'adhérence",)),
} | {
    f"{device}_{curve}": (
        tuple(f"{one} {other}" for one in of_device[0] for other in of_curve[0]),
        tuple(f"{one} {other}" for one in of_device[1] for other in of_curve[1]),
    )
    for device, of_device in _DEVICES.items()
    for curve, of_curve in _CURVES.items()
}
GERMAN = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})


def plain(name: str) -> str:
    """Return a name in small ASCII letters, digits and underscores."""
    whole = unicodedata.normalize("NFC", name).casefold()
    letters = unicodedata.normalize("NFD", whole.translate(GERMAN))
    bare = "".join(letter for letter in letters if not unicodedata.combining(letter))
    return re.sub(r"[^a-z0-9]+", "_", bare).strip("_")


def words_of(column: str) -> tuple[str, ...]:
    """Return the German and French words of a column, as `plain` returns them, each once."""
    return tuple(dict.fromkeys(plain(word) for words in COLUMN_WORDS.get(column, ((), ())) for word in words))


#: Remedies for words that look like those of a column, where they are none.
FALSE_FRIENDS = {
    **{
        f"{word}_{position}": "A vehicle must have one brake weight, that of its position: brake_weight."
        for word in ("bremsgewicht", "masse_freinee", "brake_weight", "braked_weight")
        for position in ("p", "g", "r", "r_mg")
    },
    **{
        plain(f"{word} {side}"): f"Lines must have a factor on the friction here: Reibungsfaktor {side}."
        for word in ("Reibwert", "Reibungszahl", "Reibbeiwert")
        for side in ("links", "rechts")
    },
    "bauart": "It can be that of the vehicle or of its brake: Bezeichnung or Bremsbauart.",
    "reibradius": "A radius of pads must be a share of the wheel's here: friction_radius.",
    "gefaelle": "A fall must be a gradient here, which is positive upwards: Neigung.",
    "pente": "A fall must be a gradient here, which is positive upwards: déclivité.",
    "beladung": "A load must be a mass here: Ladung.",
    **dict.fromkeys(
        ("radius", *words_of("radius")), "A radius must be a curvature here, 1 / radius, above 0 to the left."
    ),
}
#: Names of columns by each word.
COLUMNS_OF = {
    word: tuple(column for column in COLUMN_WORDS if word in words_of(column))
    for column in COLUMN_WORDS
    for word in words_of(column)
}
#: As `plain` returns them: words of KIND_OR_NAME, and other names of the kind.
EITHER = {plain(word) for words in KIND_OR_NAME for word in words}
CLEAR_KINDS = {"kind", *words_of("kind")} - EITHER


def column_meant(name: str, known: Collection[str], row: Iterable[str] = ()) -> str | None:
    """Return the known column that a word means as a name, or None. Raises ValueError if it means several.

    row: all names of the table; beside a kind, a word of KIND_OR_NAME is the name.
    """
    if "name" in known and plain(name) in EITHER and CLEAR_KINDS & set(map(plain, row)):
        return "name"
    found = [column for column in COLUMNS_OF.get(plain(name), ()) if column in known]
    if len(found) > 1:
        raise ValueError(f"the name {quoted(name)} can be {' or '.join(found)}. Write one of these.")
    return found[0] if found else None


def with_columns(
    table: Mapping[str, Any], known: Collection[str], notes: dict[str, None] | None = None
) -> dict[str, Any]:
    """Return a table with the names of columns instead of German and French ones.

    Adds a message to the notes for each name that is read as another. Raises ValueError if a column is named twice.
    """
    found: dict[str, Any] = {}
    row = [name for name in table if isinstance(name, str)]
    for name, value in table.items():
        column = name if name in known or not isinstance(name, str) else column_meant(name, known, row) or name
        if column in found:
            raise ValueError(
                f"{column} must be given once; it is there twice, also as {quoted(str(name))}. Remove one."
            )
        found[column] = value
        if notes is not None and column != name:
            notes[read_as(str(name), column)] = None
    return found


def read_as(name: str, column: str) -> str:
    """Return the message of an account about a name that is read as a column."""
    return f"column {quoted(name)} is read as {column}"


def nearest(name: str, known: Collection[str]) -> str:
    """Return the remedy for a name that is like a column or a word of one, or nothing."""
    words = {plain(word): word for column in known for of in COLUMN_WORDS.get(column, ()) for word in of}
    words |= {plain(column): column for column in known}
    near = difflib.get_close_matches(plain(name)[:100], list(words), 1, ALIKE)
    return f"Did you mean {words[near[0]]}?" if near else ""


def false_friend(name: str) -> str:
    """Return the remedy for a name that looks like that of a column, or nothing."""
    return FALSE_FRIENDS.get(plain(name), "")
