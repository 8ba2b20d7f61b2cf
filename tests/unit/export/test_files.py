"""What the exported files say: header, settings, names, vectors, page; and what cannot break out of them."""

import csv
import dataclasses
import html
import io
import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.export import TARGETS, export
from lostmotion.export.dialects import restore
from lostmotion.export.reader import Program
from lostmotion.export.reserved import CONVERSION, GROUPS, WORDS, why_reserved
from lostmotion.export.source import real_text
from tests.support.exports import KINDS, REALS, block, source

EVERY = [(kind, to, real) for kind in KINDS for to in TARGETS for real in REALS]
NASTY = 'FIC-101 *) (* */ /* ]]> <b> & "ü" \\ // ?? \n END_VAR {x} -- é'


def code(kind, to, real, **header):
    return TARGETS[to].files(source(kind, real, **header))


@pytest.mark.parametrize("to", TARGETS)
def test_header_says_where_it_is_from(to):
    files = code("dead zone", to, "lreal", data="fic.csv", fit="left 45", interval="44 .. 46")
    text = html.unescape(next(iter(files.values())))
    for said in ("fic.csv", "left 45", "44 .. 46", "2026-01-31", "lostmotion", "from a test", "10 .. 90", "0.1 s"):
        assert said in text, said
    assert "not verified in the vendor's tool" in text or to == "c"


@pytest.mark.parametrize("to", TARGETS)
def test_same_input_same_files(to):
    assert code("backlash", to, "real") == code("backlash", to, "real")


@pytest.mark.parametrize("to", TARGETS)
def test_nothing_in_the_header_becomes_code(to):
    def bare(**header):
        text = restore(code("dead zone", to, "lreal", **header))
        return re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)

    assert bare(data=NASTY, fit=NASTY, interval=NASTY) == bare()


@pytest.mark.parametrize("to", TARGETS)
def test_files_are_ascii(to):
    for text in code("dead zone", to, "lreal", data=NASTY).values():
        assert text.isascii()
        assert "\t" not in text


@pytest.mark.sampled(14)
@pytest.mark.parametrize(("kind", "to", "real"), EVERY)
def test_defaults_are_the_settings(kind, to, real):
    program = Program(restore(code(kind, to, real)))
    for name, value in source(kind, real).values.items():
        assert float(program.variables[name].value) == value, name


@pytest.mark.sampled(23)
@pytest.mark.parametrize(("kind", "to", "real"), EVERY)
def test_only_what_every_tool_takes(kind, to, real):
    text = re.sub(r"\(\*.*?\*\)|/\*.*?\*/", "", "\n".join(code(kind, to, real).values()), flags=re.S)
    assert not re.search(r"\bVAR (RETAIN|CONSTANT)|\bT#|\bTIME\b|\bRETURN\b", text)
    if to not in ("c", "plcopen", "l5x"):
        assert "//" not in text
    program = Program(restore(code(kind, to, real)))
    for name in program.variables:
        assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name), name
        assert len(name) <= 32
        assert why_reserved(name) is None, name
        assert name == name.lower()


@pytest.mark.sampled(9)
@pytest.mark.parametrize(("kind", "to", "real"), EVERY)
def test_inputs_outputs_and_settings_keep_their_names(kind, to, real):
    program = Program(restore(code(kind, to, real)))
    for section in ("input", "parameter", "output"):
        for variable in source(kind, real).specification.section(section):
            assert variable.name.lower() in program.variables


def test_reserved_words_are_single_words_in_lower_case():
    assert len(GROUPS) > 10
    for word in WORDS:
        assert re.fullmatch(r"[a-z][a-z0-9_]*", word), word


@pytest.mark.parametrize(
    "name",
    ["ramp", "RAMP", "Integral", "sema", "BCD_TO_INT", "int_to_real", "TRUNC", "r_trig", "limitalarm", "pide",
     "norm_x", "norm_X", "restrict", "fabs", "and_then", "BLINK", "to_lreal", "op_out", "Offset"],
)  # fmt: skip
def test_a_block_name_that_a_tool_has_taken_is_refused_with_another(name):
    with pytest.raises(ParameterError, match=rf"no tool has taken, got {name} \(.+\); e\.g\. {name}_comp"):
        export(block("backlash"), name=name, date="2026-01-31")
    assert export(block("backlash"), name=f"{name}_comp", date="2026-01-31").replay(rows=20).agrees


def test_conversions_between_all_types_are_taken():
    for name in ("dint_to_lreal", "bool_to_date_and_time", "byte_to_gray", "gray_to_byte", "trunc_real_int"):
        assert CONVERSION.fullmatch(name)
    for name in ("way_to_go", "time_to_go", "int_to_real_comp"):
        assert not CONVERSION.fullmatch(name)


@pytest.mark.parametrize("to", ["tcpou", "plcopen", "l5x"])
@pytest.mark.parametrize("kind", KINDS)
def test_xml_is_well_formed(kind, to):
    for text in code(kind, to, "lreal", data=NASTY).values():
        ET.fromstring(text.encode())  # noqa: S314  our own file


def test_the_st_in_plcopen_and_twincat_is_the_st_file():
    def body(text):
        return re.sub(r"\s+", " ", re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)).split("END_VAR")[-1].strip()

    texts = [body(restore(code("dead zone", to, "real"))) for to in ("st", "plcopen", "tcpou")]
    assert texts[0] == texts[1] == texts[2]


@pytest.mark.parametrize("kind", KINDS)
def test_scl_keeps_to_its_rules(kind):
    text = re.sub(r"\(\*.*?\*\)", "", code(kind, "scl", "lreal")["FY_101.scl"], flags=re.S)
    head, body = text.split("\nBEGIN\n")
    assert re.search(r'^FUNCTION_BLOCK "FY_101"\n\{ S7_Optimized_Access := \'TRUE\' \}\nVERSION : 0.1$', head, re.M)
    declared = set(re.findall(r"^ +(\w+) : (?:LReal|Bool|DInt)", head, re.M))
    used = set(re.findall(r"#(\w+)", body))
    assert used <= declared
    words = set(re.findall(r"(?<![#\w])[A-Za-z]\w*", body))
    allowed = {"IF", "THEN", "ELSIF", "ELSE", "END_IF", "AND", "OR", "NOT", "TRUE", "FALSE", "MIN", "MAX", "IN1", "IN2",
               "ABS", "DINT_TO_LREAL", "LREAL_TO_DINT", "END_FUNCTION_BLOCK"}  # fmt: skip
    assert words <= allowed
    assert len(re.findall(r"\bIF\b", body)) == body.count("END_IF;")
    assert body.count("(") == body.count(")")


@pytest.mark.parametrize("real", REALS)
def test_l5x_keeps_to_its_rules(real):
    root = ET.fromstring(code("dead zone", "l5x", real)["FY_101.L5X"].encode())  # noqa: S314  our own file
    block_ = root.find("./Controller/AddOnInstructionDefinitions/AddOnInstructionDefinition")
    assert block_.attrib["Name"] == root.attrib["TargetName"] == "FY_101"
    parameters = block_.findall("./Parameters/Parameter")
    assert [each.attrib["Name"] for each in parameters[:2]] == ["EnableIn", "EnableOut"]
    for each in [*parameters[2:], *block_.findall("./LocalTags/LocalTag")]:
        formats = {data.attrib["Format"] for data in each.findall("DefaultData")}
        assert formats == {"L5K", "Decorated"}
        assert each.attrib["DataType"] in (real.upper(), "BOOL", "DINT")
    routines = {each.attrib["Name"]: each for each in block_.findall("./Routines/Routine")}
    assert set(routines) == {"Logic", "Prescan"}
    lines = routines["Logic"].findall("./STContent/Line")
    assert [int(line.attrib["Number"]) for line in lines] == list(range(len(lines)))
    text = re.sub(r"\(\*.*?\*\)", "", "\n".join(line.text for line in lines))
    assert not re.search(r"\b(MIN|MAX|LIMIT|TRUE|FALSE|DINT_TO_\w+)\b|#", text)
    if real == "lreal":
        for value in re.findall(r":= (.*);", text):
            assert len(re.findall(r"(?<=\w |\) )[-+*/] ", value)) <= 1, value
    reset = {line.text.split(" := ")[0] for line in routines["Prescan"].findall("./STContent/Line")[1:]}
    assert reset == {variable.name.lower() for variable in source("dead zone").specification.section("state")}


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_vectors_hold_what_the_code_gives(kind, real):
    done = export(block(kind), "st", name="FY_101", date="2026-01-31", real=real)
    rows = list(csv.DictReader(io.StringIO(done.files["FY_101_vectors.csv"])))
    specification = done.source.specification
    inputs = [variable.name.lower() for variable in specification.section("input")]
    outputs = [variable.name.lower() for variable in specification.section("output")]
    program = Program(restore(done.code))
    found = program.run({}, inputs, [[float(row[name]) for name in inputs] for row in rows], outputs)
    expected = np.array([[float(row[name]) for name in outputs] for row in rows])
    np.testing.assert_array_equal(found.astype(np.float64), expected.astype(done.source.dtype))
    assert np.isfinite(expected).all()
    assert set(expected[:, outputs.index("state")]) == {0.0, 1.0, 2.0, 3.0, 4.0}


def test_the_page_has_every_setting_and_the_way_back():
    done = export(block("backlash"), "scl", name="FY_101", date="2026-01-31")
    page = done.files["FY_101_commissioning.md"]
    rows = dict(re.findall(r"^\| `(\w+)` \| (?:LREAL|BOOL|DINT) \| ([^|]+) \|", page, re.MULTILINE))
    for name, value in done.source.values.items():
        assert float({"FALSE": "0", "TRUE": "1"}.get(rows[name], rows[name])) == value
    for word in (
        "not been verified in the vendor's tool",
        "Back out",
        "without a bump",
        "TIA Portal",
        "FY_101_vectors.csv",
    ):
        assert word in page


def test_written_files_are_not_overwritten(tmp_path):
    done = export(block("backlash"), "c", name="FY_101", date="2026-01-31")
    paths = done.write(tmp_path / "new")
    assert [path.name for path in paths] == list(done.files)
    paths[0].unlink()
    with pytest.raises(FileAccessError, match=r"FY_101\.c.*force=True"):
        done.write(tmp_path / "new")
    assert not paths[0].exists()
    assert done.write(tmp_path / "new", force=True) == paths


@pytest.mark.parametrize(
    ("change", "value"),
    [("to", "ladder"), ("name", "en"), ("date", "31.1.2026"), ("date", "2026-W05-6"), ("real", "float")],
)
def test_bad_arguments(change, value):
    arguments = {"to": "st", "name": "FY_101", "date": "2026-01-31", "real": "lreal", change: value}
    with pytest.raises(ParameterError, match=r"expected .*, got .*; "):
        export(block("backlash"), **arguments)


def test_settings_must_fit_the_types():
    for settings in ({"pulse_scans": 1.5}, {"hold_on_disable": 0.5}, {"count_limit": 2.0**31}):
        with pytest.raises(ParameterError):
            export(block("backlash", **settings), name="FY_101", date="2026-01-31")
    with pytest.raises(ParameterError, match=r"high as 0, or from 1e-12 to 1e\+09, got 1e\+300"):
        export(block("backlash", high=1e300), name="FY_101", date="2026-01-31", real="real")


def test_numbers_read_back_exactly():
    random = np.random.default_rng(0)
    for value in [0.0, 1.0, 1e-6, 1e22, 0.1, *random.normal(size=50), *10.0 ** random.uniform(-30, 30, 50)]:
        assert float(real_text(value, "lreal")) == value
        assert np.float32(real_text(value, "real")) == np.float32(value)
        assert re.fullmatch(r"-?\d+\.\d+(E-?\d+)?", real_text(value, "lreal"))


def test_source_is_frozen():
    with pytest.raises(dataclasses.FrozenInstanceError):
        source("backlash").name = "other"
