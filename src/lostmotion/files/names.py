"""What columns are called: the one table of names, of words in five languages and of the tags of control systems.

To add a system or a language, add its words here: lower case, without accents, one blank between words.
"""

from __future__ import annotations

# Whole names. "cv" is none: it is the controlled variable in one place and the control valve in another.
# "input" and "output" are none either: of the plant or of the controller?
ALIASES: dict[str, tuple[str, ...]] = {
    "op": (
        "co", "mv", "out", "u", "controller output", "controller out", "manipulated variable",
        "stellgrosse", "stellgroesse", "stellgrad", "stellwert", "stellsignal", "reglerausgang",
        "regler ausgang", "ausgang regler", "ausgang des reglers",
        "commande", "sortie regulateur", "sortie du regulateur",
        "salida controlador", "salida del controlador", "salida regulador", "salida del regulador",
        "saida do controlador", "saida controlador",
    ),
    "pv": (
        "y", "measurement", "process value", "process variable", "measured value", "meas",
        "istwert", "regelgrosse", "regelgroesse", "messwert", "prozesswert",
        "mesure", "valeur mesuree", "grandeur mesuree", "grandeur reglee",
        "medida", "medicion", "valor medido", "variable de proceso", "valor de proceso",
        "medicao", "variavel de processo", "valor de processo",
    ),
    "sp": (
        "sv", "spt", "setpoint", "set point", "r", "ref", "reference",
        "sollwert", "fuhrungsgrosse", "fuehrungsgroesse", "consigne", "point de consigne", "valeur de consigne",
        "consigna", "punto de consigna", "punto de ajuste", "valor de consigna", "referencia", "ponto de ajuste",
    ),
    "position": (
        "pos", "zt", "stem", "stem position", "valve position", "actuator position", "travel",
        "ventilstellung", "stellungsruckmeldung", "hub", "position vanne", "recopie de position",
        "posicion valvula", "posicion de la valvula", "posicao da valvula",
    ),
    "mode": (
        "loop mode", "controller mode", "control mode", "auto man", "auto/man", "a/m",
        "betriebsart", "modus", "modo",
    ),
    "time": (
        "timestamp", "time stamp", "datetime", "date time", "date/time", "date", "t", "elapsed", "elapsed time", "ts",
        "zeit", "zeitstempel", "zeitpunkt", "datum", "datum uhrzeit", "datum/uhrzeit", "datum/zeit",
        "temps", "horodatage", "horodate", "date heure", "date et heure", "date/heure",
        "tiempo", "fecha", "fecha hora", "fecha y hora", "fecha/hora", "marca de tiempo",
        "tempo", "data", "data hora", "data e hora", "data/hora",
    ),
}  # fmt: skip
SAMPLING_NAMES = ("ts", "dt", "sampling time", "sample time")
DATES = ("date", "day", "datum", "fecha", "data")  # beside CLOCKS
CLOCKS = ("time", "time of day", "clock", "uhrzeit", "zeit", "heure", "hora")

# Last words of a tag, behind "." "/" or ":" (FIC101.OUT); those of ENDS_ANYWHERE behind a blank, "_" or "-" too.
ENDS: dict[str, tuple[str, ...]] = {
    "op": ("op", "out", "co", "mv", "out cv", "out value", "opout", "lmn", "out pct"),
    "pv": ("pv", "meas", "pv cv", "pv value", "pv in", "measurement"),
    "sp": ("sp", "sv", "spt", "sp cv", "sp value", "sp int", "setpoint"),
    "mode": ("mode", "mode actual", "mode cv", "modeattr", "mode act"),
}
ENDS_ANYWHERE = frozenset({"op", "pv", "sp", "mode"})

# ISA-5.1: first letter of a tag, and the letters behind it.
LOOP_TYPES = {
    "F": "flow", "P": "pressure", "L": "level", "T": "temperature", "A": "analyser",
}  # fmt: skip
MEASURES = ("T", "I", "IT", "TI", "DT", "DI")  # FT, FI, FIT; PDT
MOVES = ("V", "CV", "Y", "DV")  # FV, FCV, FY
CONTROLS = ("C", "IC", "RC", "DC", "DIC")  # FC, FIC, FRC, PDIC

SECONDS = {
    "ms": 1e-3, "msec": 1e-3, "milliseconds": 1e-3, "s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0,
    "min": 60.0, "mins": 60.0, "minutes": 60.0, "h": 3600.0, "hr": 3600.0, "hours": 3600.0,
}  # fmt: skip
UNITS = frozenset({
    "%", "pct", "percent", "prozent", "degc", "degf", "°c", "°f", "c", "f", "k", "bar", "barg", "bara", "mbar", "pa",
    "kpa", "mpa", "psi", "psig", "psia", "m3/h", "m³/h", "l/h", "l/min", "t/h", "kg/h", "kg/s", "gpm", "lpm", "rpm",
    "m", "mm", "cm", "ma", "v", "ppm", "nm3/h", "sm3/h", "scfm", "scfh", "kscfh", "mmscfd", "bbl/d", "bpd", "m3/d",
    "t/d", "lb/h", "klb/h", "kg/m3", "kw", "mw", "hz", "kj/kg", "l/s", "m3/s", "m/s", "inh2o", "mmh2o", "mmhg",
})  # fmt: skip
# What else stands in a row of units.
UNIT_ROW = UNITS | frozenset(SECONDS) | frozenset({
    "-", "n/a", "na", "none", "in", "ph", "eu", "unit", "units", "date", "time", "datetime", "local time", "utc",
    "text", "mode", "dd/mm/yyyy", "mm/dd/yyyy", "yyyy-mm-dd", "dd.mm.yyyy", "hh:mm:ss", "dd/mm/yyyy hh:mm:ss",
    "mm/dd/yyyy hh:mm:ss", "yyyy-mm-dd hh:mm:ss", "dd.mm.yyyy hh:mm:ss",
})  # fmt: skip

# A row for each value of each tag: what the columns are called, and what a good quality is.
LONG: dict[str, tuple[str, ...]] = {
    "tag": ("tag", "tagname", "tag name", "point", "point name", "pointname", "pi tag", "item", "signal", "variable",
            "messstelle", "messstellenname", "etiqueta", "nom", "nombre", "name"),
    "value": ("value", "val", "wert", "messwert", "valeur", "valor"),
    "quality": ("quality", "qual", "status", "opc quality", "qualitat", "qualite", "calidad", "qualidade"),
    "unit": ("unit", "units", "eu", "einheit", "unite", "unidad", "unidade"),
}  # fmt: skip
BESIDE = (
    "id",
    "index",
    "row",
    "no",
    "nr",
    "unit",
    "units",
    "eu",
    "description",
    "einheit",
    "unite",
    "unidad",
    "unidade",
)
GOOD_QUALITY = frozenset({
    "good", "ok", "g", "c0", "valid", "gut", "gultig", "bon", "bonne", "bueno", "buena", "bom", "boa",
})  # fmt: skip
UNCERTAIN_QUALITY = frozenset({
    "questionable", "u", "q", "suspect", "doubtful", "substituted", "unsicher", "fraglich", "incertain", "douteux",
    "incierto", "dudoso", "incerto", "duvidoso",
})  # fmt: skip
BAD_QUALITY = frozenset({
    "b", "x", "failed", "not good", "schlecht", "gestort", "ungultig", "mauvais", "mauvaise", "invalide", "malo",
    "mala", "ruim", "invalido",
})  # fmt: skip
