import pytest

from lostmotion.errors import ColumnError
from lostmotion.files import columns
from lostmotion.files.columns import by_alias, columns_of_loops, key, resolve, time_unit

NAMES = {
    "op": ["OP", "op", "CO", "MV", "out", "u", "Controller Output", "controller_output (%)"],
    "pv": ["PV", "pv", "y", "Measurement", "process_value [m3/h]"],
    "sp": ["SP", "setpoint", "Set Point", "r", "ref", "SV"],
    "position": ["position", "ZT", "Stem", "valve position (%)"],
    "time": ["time", "Timestamp", "t", "t_s", "Date", "Time [ms]"],
}


@pytest.mark.parametrize(("role", "name"), [(role, name) for role, names in NAMES.items() for name in names])
def test_usual_names_are_found(role, name):
    columns = {"op": "OP", "pv": "PV", "sp": "SP", "position": "position", "time": "time"} | {role: name}
    found = resolve(list(columns.values()))
    assert {role: getattr(found, role) for role in columns} == columns


def test_alias_is_noted_but_exact_name_is_not():
    assert resolve(["OP", "y"]).notes == ("PV was read from column 'y'.",)
    assert resolve(["op", "Pv"]).notes == ()


def test_exact_name_wins_over_alias():
    assert resolve(["Timestamp", "Time", "CO", "OP", "PV"]).op == "OP"
    assert resolve(["Timestamp", "Time", "OP", "PV"]).time == "Time"


@pytest.mark.parametrize(("names", "said"), [(["CO", "MV", "PV"], "op='CO'"), (["OP", "PV", "SV", "ref"], "sp=")])
def test_two_aliases_are_refused(names, said):
    with pytest.raises(ColumnError, match=said):
        resolve(names)


def test_cv_input_and_output_are_no_aliases():
    for name in ("CV", "input", "output"):
        assert by_alias("op", [name]) is None
        assert by_alias("pv", [name]) is None


def test_tag_with_suffix():
    found = resolve(["FIC-101.OP", "FIC-101.PV", "FIC-101.SP"])
    assert (found.op, found.pv, found.sp) == ("FIC-101.OP", "FIC-101.PV", "FIC-101.SP")
    assert resolve(["FIC-101.OP", "FIC-102.OP", "FIC-101.PV"]).op == "FIC-101.OP"
    with pytest.raises(ColumnError, match="one column for OP"):
        resolve(["FIC-101.OP", "FIC-102.OP", "FT-101.PV"])


TAGS = {
    "DeltaV": ("FIC-{n}/PID1/OUT.CV", "FIC-{n}/PID1/PV.CV", "FIC-{n}/PID1/SP.CV"),
    "Foxboro": ("UNIT1:FIC{n}.OUT", "UNIT1:FIC{n}.MEAS", "UNIT1:FIC{n}.SPT"),
    "Yokogawa": ("FIC{n}.MV", "FIC{n}.PV", "FIC{n}.SV"),
    "Honeywell": ("FIC{n}.OP", "FIC{n}.PV", "FIC{n}.SP"),
    "Honeywell Experion": ("FIC{n}.PIDA.OP", "FIC{n}.PIDA.PV", "FIC{n}.PIDA.SP"),
    "with units": ("FIC{n}.OP [%]", "FIC{n}.PV [m3/h]", "FIC{n}.SP (m3/h)"),
    "underscores": ("FIC_{n}_OP", "FIC_{n}_PV", "FIC_{n}_SP"),
    "blanks": ("FIC {n} OP %", "FIC {n} PV t/h", "FIC {n} SP t/h"),
}


@pytest.mark.parametrize("system", TAGS)
def test_tags_of_control_systems(system):
    one, two = ([name.format(n=n) for name in TAGS[system]] for n in (101, 102))
    found = resolve(["Time", *one])
    assert [found.op, found.pv, found.sp] == one
    with pytest.raises(ColumnError, match="2 loops") as caught:
        resolve(["Time", *one, *two])
    for way, names in zip(caught.value.ways, (one, two), strict=True):
        found = resolve(["Time", *one, *two], **way)
        assert [found.op, found.pv, found.sp] == names
    assert resolve(["Time", *one, *two], op=two[0]).pv == two[1]
    with pytest.raises(ColumnError, match="FIC999"):
        resolve(["Time", *one, *two], loop="FIC999")


@pytest.mark.parametrize(
    "header",
    [
        ("Zeit", "Stellgröße", "Istwert", "Sollwert"),
        ("Zeitstempel", "Stellgrad [%]", "Regelgröße [m³/h]", "Führungsgröße"),
        ("Horodatage", "Commande", "Mesure", "Consigne"),
        ("Fecha y hora", "Salida del controlador", "Medición", "Consigna"),
        ("Data/Hora", "Saída do controlador", "Medição", "Referência"),
    ],
)
def test_headers_in_other_languages(header):
    found = resolve(header)
    assert (found.time, found.op, found.pv, found.sp) == header


def test_isa_tags_of_one_letter_and_number_are_a_loop():
    found = resolve(["id", "FT_211", "FV_211"])
    assert (found.op, found.pv) == ("FV_211", "FT_211")
    with pytest.raises(ColumnError) as caught:
        resolve(["id", "FT_115", "LV_106"])
    assert caught.value.ways == ({"op": "LV_106", "pv": "FT_115"},)
    assert resolve(["FT_211", "FV_211", "FT_212", "FV_212"], loop="FIC-212").op == "FV_212"


def test_a_temperature_at_an_outlet_is_no_controller_output():
    with pytest.raises(ColumnError):
        resolve(["T_out", "T_in", "PV"])


def test_who_names_op_and_pv_is_not_asked_for_sp():
    names = ["Time", "FIC1.OUT", "FIC1.MEAS", "FIC1.SP", "FIC2.OUT", "FIC2.MEAS", "FIC2.SP", "FIC2.SPT"]
    assert resolve(names, op="FIC1.OUT", pv="FIC1.MEAS").sp == "FIC1.SP"
    open_sp = resolve(names, op="FIC2.OUT", pv="FIC2.MEAS")
    assert open_sp.sp is None
    assert "SP was not read" in " ".join(open_sp.notes)
    assert resolve(names, op="FIC2.OUT", pv="FIC2.MEAS", sp="FIC2.SPT").sp == "FIC2.SPT"
    assert resolve(["A", "B", "SP", "FIC2.SP"], op="A", pv="B").sp == "SP"
    with pytest.raises(ColumnError, match="one column for SP"):
        resolve(["OP", "PV", "A.SP", "B.SP"])


def test_explicit_name_is_exact_or_without_case():
    assert resolve(["lc74_20cv_pct", "PV"], op="LC74_20CV_pct").op == "lc74_20cv_pct"
    assert resolve(["Aa", "AA", "PV"], op="AA").op == "AA"
    with pytest.raises(ColumnError, match="exact case"):
        resolve(["Aa", "AA", "PV"], op="aa")


def test_explicit_name_is_never_replaced_by_an_alias():
    with pytest.raises(ColumnError, match=r"expected a column 'MV', got \['CO', 'PV'\]"):
        resolve(["CO", "PV"], op="MV")
    with pytest.raises(ColumnError, match="setpoint"):
        resolve(["OP", "PV"], sp="setpoint")


def test_missing_op_and_pv():
    with pytest.raises(ColumnError, match=r"expected a column 'OP', got \['a', 'PV'\].*name it with op="):
        resolve(["a", "PV"])


def test_near_name_is_offered():
    with pytest.raises(ColumnError, match="did you mean 'voltage'"):
        resolve(["voltage", "rpm"], op="voltages", pv="rpm")


def test_optional_columns():
    assert resolve(["OP", "PV"]).sp is None
    assert resolve(["OP", "PV", "SP", "ZT"]).position == "ZT"
    found = resolve(["t", "OP", "PV", "SP", "ZT"], sp=None, position=False, time=False)
    assert (found.sp, found.position, found.time) == (None, None, None)


def test_one_column_cannot_play_two_roles():
    with pytest.raises(ColumnError, match="for both"):
        resolve(["a", "b"], op="a", pv="A")


def test_named_column_is_not_taken_again_as_alias():
    assert resolve(["u", "y", "MV"], op="u", pv="y").op == "u"


def test_key_and_unit():
    assert key("Set-Point (m3/h)") == "set point"
    assert time_unit("elapsed time [s]") == 1.0
    assert time_unit("t_h") == 3600.0
    assert time_unit("s") is None


@pytest.mark.parametrize(
    "names",
    [
        ["FIC101.OP", "FIC101.PV"],
        ["FIC-101/AO1/OUT.CV", "FIC-101/PID1/PV.CV"],
        ["FV101.OUT", "FIC101.PV"],
        ["OP", "FIC102.PV"],
    ],
)
def test_op_and_pv_of_one_loop(names):
    found = resolve(["t", *names])
    assert [found.op, found.pv] == names


@pytest.mark.parametrize("names", [["FIC101.OP", "FIC102.PV"], ["FIC101_OP", "PIC101_PV"]])
def test_op_and_pv_of_two_loops_are_refused(names):
    with pytest.raises(ColumnError, match="OP and PV of one loop") as caught:
        resolve(["t", *names])
    (way,) = caught.value.ways
    assert resolve(["t", *names], **way).pv == names[1]


@pytest.mark.parametrize(
    "form", [("FIC{}.OP", "FIC{}.PV"), ("FV_{}", "FT_{}"), ("FC{}/PID1/OUT.CV", "FC{}/PID1/PV.CV")]
)
@pytest.mark.parametrize("rest", [(), ("Time",), ("SP", "Mode"), ("FIC1.SP", "FIC2.MODE", "TI9.PV", "x")])
def test_all_loops_at_once_are_those_one_by_one(form, rest):
    names = [*rest, *(one.format(number) for number in range(100, 105) for one in form)]
    found = columns_of_loops(names)
    assert found
    assert found == {tag: resolve(names, loop=tag) for tag in found}


def test_the_work_grows_with_the_number_of_columns(monkeypatch):
    """Four times the columns may take five times the look-ups, and not sixteen."""
    counts = []
    for size in (200, 800):
        names = ["Time", *(f"FIC{number}.{role}" for number in range(size) for role in ("OP", "PV"))]
        seen = []
        monkeypatch.setattr(columns, "key", lambda name, seen=seen: seen.append(name) or name.strip().lower())
        columns_of_loops(names)
        counts.append(len(seen))
    assert counts[1] < 5 * counts[0]


def test_one_column_is_not_op_and_pv():
    with pytest.raises(ColumnError, match="different columns for PV and OP, got 'OP' for both"):
        resolve(["time", "OP", "PV"], op="OP", pv="op")
