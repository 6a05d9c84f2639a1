// Results of a sweep in one SQLite file (README.md lists tables and views). Each point is written
// as soon as it is finished, in a transaction of its own: a process that dies leaves whole points
// only. Several processes may write to one file; a point that two of them finish is there once.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "tools/app/study/sweep/point_run.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sqlite.h"

namespace leviosim::tools {

inline constexpr const char* kSweepFile = "sweep.sqlite";
inline constexpr const char* kSweepCsv = "sweep.csv";

/// A finished point as the report needs it.
struct SweepOutcome {
  int point = 0;
  std::string failure;  ///< empty if there are figures
  std::array<std::optional<double>, kObjectives.size()> objectives;
};

class SweepStore {
 public:
  /// Opens the file, or makes it with the points of a sweep.
  /// @param plan  its text
  /// @throws InputError if it holds another sweep
  SweepStore(const std::filesystem::path& folder, const std::string& plan,
             const std::vector<SweepPoint>& points);
  /// Opens what is there. @throws InputError if it is no sweep's
  explicit SweepStore(const std::filesystem::path& folder,
                      Database::Mode mode = Database::Mode::read_only);

  std::set<int> finished();
  void put(int point, const Outcome& result);

  /// Takes over all that another has finished. @throws InputError if it is of another sweep, or if
  /// both have a point with different results
  void merge(SweepStore& other);
  /// Makes a new file with the same points and nothing finished, if there is none.
  void copy_plan_to(const std::filesystem::path& folder);

  /// What is kept of a point; nothing of one that is not finished.
  std::optional<Outcome> result_of(int point);
  /// In the order of their numbers.
  std::vector<SweepOutcome> outcomes();
  /// That the points set, in the order of the plan.
  std::vector<std::string> parameter_names();
  /// "platform.cluster.clock=240MHz" of a point.
  std::string settings_of(int point);
  std::int64_t planned();
  /// point_key() of a point; empty if there is no such point.
  std::string key_of(int point);

  /// Remembers where the plan lies, since what it names lies beside it.
  void keep_place(const std::filesystem::path& plan);
  /// That file, which may be gone; nothing if none was remembered.
  std::optional<std::filesystem::path> place();
  std::string plan_text() { return fact("plan").value_or(""); }
  /// Digest of the sources of the program that made the file.
  std::string simulator() { return fact("simulator").value_or(""); }

  /// Numbers of the points on the Pareto front at the last publish().
  std::set<int> front();

  /// Brings views, front and sweep.csv up to date: a row per finished point, a column per parameter
  /// and figure, in an order that does not depend on which was finished first.
  /// @returns nothing, or why sweep.csv has another name now
  [[nodiscard]] std::optional<std::string> publish(outputs::OutputFile& file);
  /// The text of sweep.csv as of the last publish().
  std::string csv();

 private:
  using Keys = std::vector<std::pair<int, std::string>>;

  void expect_known_format();
  /// A row of the table `sweep`.
  std::optional<std::string> fact(std::string_view name);
  Keys keys();
  bool holds(const std::vector<SweepPoint>& points);
  void plan(const std::vector<SweepPoint>& points);
  void write(int point, const Outcome& result);
  std::vector<std::string> figure_names();
  void write_front();
  void make_views(const std::vector<std::string>& parameters,
                  const std::vector<std::string>& figures);

  std::filesystem::path folder_;
  Database database_;
};

/// Whether a folder's data base is a sweep's; `may_be_empty`: also one without any table.
/// @throws InputError if it is no data base
bool is_sweep(const std::filesystem::path& folder, bool may_be_empty);
/// Takes all of the sweep out of the data base, or nothing.
void empty_sweep(const std::filesystem::path& folder);

// Tables and fixed views of sweep.sqlite.

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
