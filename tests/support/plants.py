"""Small plants in every shape that a source can have, with the same data in them."""

import sqlite3
from datetime import UTC, datetime, timedelta

import numpy as np
import polars as pl

N = 240
START = datetime(2026, 3, 1, 6, tzinfo=UTC)
TAGS = ("FIC101", "LIC102", "PIC103")


def signals(number, n=N):
    rng = np.random.default_rng(number)
    op = np.round(50 + 9 * np.sin(np.arange(n) / (7 + number)) + rng.normal(size=n), 2)
    return {"OP": op, "PV": np.round(20 + 0.3 * op + rng.normal(size=n), 3), "SP": np.full(n, 35.0 + number)}


def frame(number, n=N, start=START):
    when = [start + timedelta(seconds=k) for k in range(n)]
    return pl.DataFrame({"time": when, **signals(number, n)})


def with_tag(number, tag):
    return frame(number).select(pl.lit(tag).alias("tag"), pl.all())


def side_by_side():
    columns = [
        frame(number).drop("time").rename({role: f"{tag}.{role}" for role in ("OP", "PV", "SP")})
        for number, tag in enumerate(TAGS)
    ]
    return pl.concat([frame(0).select("time"), *columns], how="horizontal")


def below_each_other():
    return pl.concat([with_tag(number, tag) for number, tag in enumerate(TAGS)])


def long():
    parts = [
        frame(number).select(pl.lit(f"{tag}.{role}").alias("tag"), "time", pl.col(role).alias("value"))
        for number, tag in enumerate(TAGS)
        for role in ("OP", "PV", "SP")
    ]
    return pl.concat(parts)


def put(path, table):
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".parquet":
        table.write_parquet(path, row_group_size=N)
    else:
        table.write_csv(path)
    return path


def database(path, table):
    rows = table.with_columns(pl.col("time").dt.strftime("%Y-%m-%dT%H:%M:%SZ"))
    names = ", ".join(f'"{name}"' for name in rows.columns)
    with sqlite3.connect(path) as base:
        base.execute(f"CREATE TABLE trend ({names})")
        base.executemany(f"INSERT INTO trend VALUES ({', '.join('?' * len(rows.columns))})", rows.rows())  # noqa: S608
    base.close()
    return f"sqlite:///{path}"


def make(kind, folder):
    """Source of a kind, as open_plant takes it, and its settings."""
    shapes = {"wide": side_by_side, "rows": below_each_other, "long": long}
    shape, _, where = kind.partition(" ")
    if where == "database":
        return database(folder / "plant.db", shapes[shape]()), {"query": "SELECT * FROM trend;"}
    if shape in shapes:
        return put(folder / f"plant.{where}", shapes[shape]()), {}
    for number, tag in enumerate(TAGS):
        for name, rows in _files(kind, where, number, tag):
            put(folder / name, rows)
    return folder, {}


def _files(kind, where, number, tag):
    """Names of the files of one loop, and what is in them."""
    whole = frame(number)
    days = [whole[:120], whole[120:]]
    roles = {role: whole.select("time", pl.col(role).alias("value")) for role in ("OP", "PV", "SP")}
    made = {
        "partitions": [(f"area=A{number}/tag={tag}/part-0.parquet", whole)],
        "dated partitions": [(f"tag={tag}/day={day + 1}/part-0.parquet", rows) for day, rows in enumerate(days)],
        "tags in partitions": [(f"tag={tag}.{role}/0.parquet", rows) for role, rows in roles.items()],
        "pieces": [(f"part-{number}.parquet", with_tag(number, tag))],
        "tags": [(f"{tag}_{role}.{where}", rows) for role, rows in roles.items()],
        "days": [(f"{tag}_2026030{day + 1}.{where}", rows) for day, rows in enumerate(days)],
        "files": [(f"unit 1/{tag}.{where}", whole)],
    }
    return made.get(kind) or made[kind.partition(" ")[0]]


KINDS = (
    "files csv", "files parquet", "wide csv", "wide parquet", "rows csv", "rows parquet", "long csv", "long parquet",
    "tags csv", "tags parquet", "days csv", "days parquet", "partitions", "dated partitions", "tags in partitions",
    "pieces", "wide database", "rows database", "long database",
)  # fmt: skip
