// Tables and fixed views of sweep.sqlite.
#pragma once

namespace leviosim::tools {

inline constexpr const char* kSweepFormat = "leviosim sweep 2";

/// Takes out all of a sweep, and nothing that others added.
inline constexpr const char* kSweepEmpty = R"(
DROP VIEW IF EXISTS wide;
DROP VIEW IF EXISTS metrics;
DROP VIEW IF EXISTS points;
DROP TABLE IF EXISTS front;
DROP TABLE IF EXISTS figure_values;
DROP TABLE IF EXISTS figures;
DROP TABLE IF EXISTS outcomes;
DROP TABLE IF EXISTS parameters;
DROP TABLE IF EXISTS planned;
DROP TABLE IF EXISTS sweep;
)";

inline constexpr const char* kSweepTables = R"(
CREATE TABLE IF NOT EXISTS sweep(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS planned(point INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS parameters(
  point INTEGER NOT NULL REFERENCES planned, place INTEGER NOT NULL, name TEXT NOT NULL,
  text TEXT NOT NULL, number REAL, unit TEXT NOT NULL, PRIMARY KEY(point, name)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS outcomes(
  point INTEGER PRIMARY KEY REFERENCES planned, failure TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS figures(
  figure INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, unit TEXT NOT NULL,
  description TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS figure_values(
  point INTEGER NOT NULL REFERENCES outcomes, figure INTEGER NOT NULL REFERENCES figures,
  place INTEGER NOT NULL, value REAL NOT NULL, PRIMARY KEY(point, figure)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS front(point INTEGER PRIMARY KEY REFERENCES outcomes);
CREATE VIEW IF NOT EXISTS points AS
  SELECT planned.point AS point,
         CASE WHEN failure IS NULL THEN 'open' WHEN failure = '' THEN 'done' ELSE 'failed' END
           AS status,
         COALESCE(failure, '') AS failure, key
  FROM planned LEFT JOIN outcomes USING (point);
CREATE VIEW IF NOT EXISTS metrics AS
  SELECT point, name, value, unit, description FROM figure_values JOIN figures USING (figure);
)";

}  // namespace leviosim::tools
