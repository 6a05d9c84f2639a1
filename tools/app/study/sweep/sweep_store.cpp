#include "tools/app/study/sweep/sweep_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "platform_models/loader/schema.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

fs::path made(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw InputError(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
  return folder / kSweepFile;
}

fs::path existing(const fs::path& folder) {
  if (!base::is_file(folder / kSweepFile))
    throw InputError(fmt::format("{}: holds no {}; expected the folder of a sweep", folder.string(),
                                 kSweepFile));
  return folder / kSweepFile;
}

/// As an SQL identifier.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

std::string literal(const std::string& text) {
  std::string sql = "'";
  for (const char c : text) sql += c == '\'' ? std::string("''") : std::string(1, c);
  return sql + '\'';
}

constexpr const char* kPlanFile = "plan file";

void say(Database& database, std::string_view name, std::string_view value) {
  Statement about(database, "INSERT OR REPLACE INTO sweep VALUES(?, ?)");
  about.bind(1, name).bind(2, value).run();
}

/// Relative, so that a sweep and its plan can be moved together.
void say_place(Database& database, const fs::path& plan, const fs::path& folder) {
  say(database, kPlanFile, fs::proximate(plan, folder).string());
}

enum class Schema { empty, of_sweep, foreign };

constexpr const char* kEntries =
    "SELECT name, type, sql, tbl_name FROM sqlite_master WHERE sql IS NOT NULL";

/// Type and SQL of a sweep's tables and views, by their names.
std::map<std::string, std::pair<std::string, std::string>> tables_of_sweep() {
  Database in_memory("", Database::Mode::create);
  in_memory.run(kSweepTables);
  std::map<std::string, std::pair<std::string, std::string>> all;
  for (Statement entry(in_memory, kEntries); entry.step();)
    all[entry.text(0)] = {entry.text(1), entry.text(2)};
  return all;
}

/// Whether the tables are those of a sweep, word by word: what else a stranger's would compute when
/// they are read is not run. Tables and views of other names are not looked at.
Schema schema_of(Database& database) {
  static const auto ours = tables_of_sweep();
  bool is_empty = true;
  std::set<std::string> found;
  for (Statement entry(database, kEntries); entry.step();) {
    is_empty = false;
    const auto same = ours.find(entry.text(0));
    if (same != ours.end()) {
      if (same->second != std::pair(entry.text(1), entry.text(2))) return Schema::foreign;
      found.insert(same->first);
    } else if (ours.count(entry.text(3)) > 0) {
      return Schema::foreign;  // an index or a trigger of our tables
    }
  }
  if (is_empty) return Schema::empty;
  return found.size() == ours.size() ? Schema::of_sweep : Schema::foreign;
}

bool is_objective(const std::string& name) {
  return std::any_of(kObjectives.begin(), kObjectives.end(),
                     [&](const Objective& o) { return o.figure == name; });
}

}  // namespace

SweepStore::SweepStore(const fs::path& folder, const std::string& plan,
                       const std::vector<SweepPoint>& points)
    : folder_(folder), database_(made(folder), Database::Mode::create) {
  Transaction transaction(database_);
  if (schema_of(database_) == Schema::foreign) database_.fail("is no file of leviosim sweep");
  database_.run(kSweepTables);
  if (planned() > 0) {
    expect_known_format();
    if (!holds(points))
      database_.fail(
          "holds the results of another plan, of other data or of another leviosim; choose a new "
          "folder, or --force to begin anew (finished points come from the cache where they are "
          "the same)");
    transaction.commit();
    return;
  }
  say(database_, "format", kSweepFormat);
  say(database_, "program", fmt::format("leviosim {} {}", version(), revision()));
  say(database_, "simulator", results_version());
  say(database_, "plan", plan);
  this->plan(points);
  transaction.commit();
}

bool SweepStore::holds(const std::vector<SweepPoint>& points) {
  if (planned() != static_cast<std::int64_t>(points.size())) return false;
  Statement select(database_, "SELECT point, key FROM planned ORDER BY point");
  for (std::size_t i = 0; select.step(); ++i) {
    throw_if_interrupted();
    if (select.whole(0) != static_cast<std::int64_t>(i) + 1 || select.text(1) != points[i].key)
      return false;
  }
  return true;
}

void SweepStore::plan(const std::vector<SweepPoint>& points) {
  Statement point(database_, "INSERT INTO planned VALUES(?, ?)");
  Statement parameter(database_, "INSERT INTO parameters VALUES(?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < points.size(); ++i) {
    throw_if_interrupted();
    const SweepPoint p = points[i];
    point.bind(1, std::int64_t{p.number}).bind(2, std::string_view(p.key)).run();
    std::int64_t place = 0;
    for (const PointParameter& v : p.parameters) {
      parameter.bind(1, std::int64_t{p.number}).bind(2, place++).bind(3, std::string_view(v.name));
      parameter.bind(4, std::string_view(v.text))
          .bind(5, v.number)
          .bind(6, std::string_view(v.unit));
      parameter.run();
    }
  }
}

SweepStore::SweepStore(const fs::path& folder, Database::Mode mode)
    : folder_(folder), database_(existing(folder), mode) {
  if (schema_of(database_) != Schema::of_sweep) database_.fail("is no file of leviosim sweep");
  expect_known_format();
}

void SweepStore::expect_known_format() {
  if (fact("format") != kSweepFormat)
    database_.fail(fmt::format("is of a version that is not known; expected '{}'", kSweepFormat));
}

std::optional<std::string> SweepStore::fact(std::string_view name) {
  Statement select(database_, "SELECT value FROM sweep WHERE name = ?");
  if (!select.bind(1, name).step()) return std::nullopt;
  return select.text(0);
}

void SweepStore::keep_place(const fs::path& plan) {
  if (place() == fs::weakly_canonical(plan)) return;
  Transaction transaction(database_);
  say_place(database_, plan, folder_);
  transaction.commit();
}

std::optional<fs::path> SweepStore::place() {
  const std::optional<std::string> plan = fact(kPlanFile);
  if (!plan) return std::nullopt;
  return fs::weakly_canonical(folder_ / *plan);
}

std::string SweepStore::key_of(int point) {
  Statement select(database_, "SELECT key FROM planned WHERE point = ?");
  return select.bind(1, std::int64_t{point}).step() ? select.text(0) : std::string();
}

SweepStore::Keys SweepStore::keys() {
  Keys all;
  Statement select(database_, "SELECT point, key FROM planned ORDER BY point");
  while (select.step()) all.emplace_back(static_cast<int>(select.whole(0)), select.text(1));
  return all;
}

std::set<int> SweepStore::finished() {
  std::set<int> points;
  Statement select(database_, "SELECT point FROM outcomes");
  while (select.step()) points.insert(static_cast<int>(select.whole(0)));
  return points;
}

std::int64_t SweepStore::planned() {
  Statement select(database_, "SELECT COUNT(*) FROM planned");
  select.step();
  return select.whole(0);
}

void SweepStore::put(int point, const Outcome& result) {
  Transaction transaction(database_);
  write(point, result);
  transaction.commit();
}

void SweepStore::write(int point, const Outcome& result) {
  Statement outcome(database_, "INSERT OR IGNORE INTO outcomes VALUES(?, ?) RETURNING point");
  outcome.bind(1, std::int64_t{point}).bind(2, std::string_view(result.failure));
  const bool is_new = outcome.step();
  outcome.reset();
  if (!is_new) return;  // another process was faster
  Statement figure(database_,
                   "INSERT OR IGNORE INTO figures(name, unit, description) VALUES(?, ?, ?)");
  Statement value(database_,
                  "INSERT INTO figure_values SELECT ?, figure, ?, ? FROM figures WHERE name = ?");
  std::int64_t place = 0;
  for (const Figure& f : result.figures) {
    figure.bind(1, std::string_view(f.name)).bind(2, std::string_view(f.unit));
    figure.bind(3, std::string_view(f.description)).run();
    value.bind(1, std::int64_t{point}).bind(2, place++);
    value.bind(3, std::optional(f.value)).bind(4, std::string_view(f.name)).run();
  }
}

std::optional<Outcome> SweepStore::result_of(int point) {
  Statement outcome(database_, "SELECT failure FROM outcomes WHERE point = ?");
  if (!outcome.bind(1, std::int64_t{point}).step()) return std::nullopt;
  Outcome result{outcome.text(0), {}};
  Statement figures(database_,
                    "SELECT name, unit, description, value FROM figure_values JOIN figures USING "
                    "(figure) WHERE point = ? ORDER BY place");
  figures.bind(1, std::int64_t{point});
  while (figures.step())
    result.figures.push_back(
        {figures.text(0), figures.text(1), figures.text(2), figures.number(3).value_or(0)});
  return result;
}

void SweepStore::merge(SweepStore& other) {
  if (keys() != other.keys())
    other.database_.fail(fmt::format("is of another plan, other data or another leviosim than {}",
                                     (folder_ / kSweepFile).string()));
  Transaction transaction(database_);
  for (const int point : other.finished()) {
    const Outcome theirs = other.result_of(point).value();
    const std::optional<Outcome> ours = result_of(point);
    if (!ours)
      write(point, theirs);
    else if (to_text(*ours) != to_text(theirs))
      other.database_.fail(fmt::format("has other results for point {} than {}", point,
                                       (folder_ / kSweepFile).string()));
  }
  transaction.commit();
}

void SweepStore::copy_plan_to(const fs::path& folder) {
  if (fs::exists(folder / kSweepFile)) return;
  Database copy(made(folder), Database::Mode::create);
  Transaction transaction(copy);
  copy.run(kSweepTables);
  const auto copy_rows = [&](const char* select, const char* insert, int columns) {
    Statement from(database_, select);
    Statement into(copy, insert);
    while (from.step()) {
      for (int c = 0; c < columns; ++c) from.bind_column(c, into);
      into.run();
    }
  };
  copy_rows("SELECT * FROM sweep", "INSERT INTO sweep VALUES(?, ?)", 2);
  copy_rows("SELECT * FROM planned", "INSERT INTO planned VALUES(?, ?)", 2);
  copy_rows("SELECT * FROM parameters", "INSERT INTO parameters VALUES(?, ?, ?, ?, ?, ?)", 6);
  if (const auto plan = place()) say_place(copy, *plan, folder);
  transaction.commit();
}

std::vector<SweepOutcome> SweepStore::outcomes() {
  std::vector<SweepOutcome> all;
  Statement select(database_, "SELECT point, failure FROM outcomes ORDER BY point");
  while (select.step()) all.push_back({static_cast<int>(select.whole(0)), select.text(1), {}});
  Statement value(database_, "SELECT value FROM metrics WHERE point = ? AND name = ?");
  for (SweepOutcome& outcome : all)
    for (std::size_t k = 0; k < kObjectives.size(); ++k) {
      value.bind(1, std::int64_t{outcome.point}).bind(2, std::string_view(kObjectives[k].figure));
      if (value.step()) outcome.objectives[k] = value.number(0);
      value.reset();
    }
  return all;
}

std::vector<std::string> SweepStore::parameter_names() {
  std::vector<std::string> names;
  Statement select(database_,
                   "SELECT name FROM parameters WHERE point = (SELECT MIN(point) FROM planned) "
                   "ORDER BY place");
  while (select.step()) names.push_back(select.text(0));
  return names;
}

std::string SweepStore::settings_of(int point) {
  std::string text;
  Statement select(database_, "SELECT name, text FROM parameters WHERE point = ? ORDER BY place");
  select.bind(1, std::int64_t{point});
  while (select.step())
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", select.text(0), select.text(1));
  return text;
}

std::vector<std::string> SweepStore::figure_names() {
  std::vector<std::string> figures;
  for (const Objective& o : kObjectives) figures.emplace_back(o.figure);
  Statement select(database_, "SELECT name FROM figures ORDER BY name");
  while (select.step())
    if (!is_objective(select.text(0))) figures.push_back(select.text(0));
  return figures;
}

void SweepStore::make_views(const std::vector<std::string>& parameters,
                            const std::vector<std::string>& figures) {
  std::string columns = "point, status, failure";
  for (const std::string& name : parameters)
    columns += fmt::format(
        ",\n (SELECT COALESCE(number, text) FROM parameters p WHERE p.point = points.point AND "
        "p.name = {}) AS {}",
        literal(name), quoted(name));
  Statement number(database_, "SELECT figure FROM figures WHERE name = ?");
  for (const std::string& name : figures) {
    const bool known = number.bind(1, std::string_view(name)).step();
    columns += known ? fmt::format(
                           ",\n (SELECT value FROM figure_values v WHERE v.point = "
                           "points.point AND v.figure = {}) AS {}",
                           number.whole(0), quoted(name))
                     : fmt::format(",\n NULL AS {}", quoted(name));
    number.reset();
  }
  database_.run("DROP VIEW IF EXISTS wide; CREATE VIEW wide AS SELECT " + columns + " FROM points");
}

std::string SweepStore::csv() {
  const std::vector<std::string> parameters = parameter_names();
  const std::vector<std::string> figures = figure_names();
  std::vector<base::Cell> cells{"point", "status"};
  cells.insert(cells.end(), parameters.begin(), parameters.end());
  cells.insert(cells.end(), figures.begin(), figures.end());
  cells.emplace_back("failure");
  std::string text = base::csv_line(cells);
  Statement row(database_, "SELECT * FROM wide WHERE status <> 'open' ORDER BY point");
  Statement value(database_, "SELECT text FROM parameters WHERE point = ? ORDER BY place");
  while (row.step()) {
    cells = {row.text(0), row.text(1)};
    value.bind(1, row.whole(0));
    while (value.step()) cells.emplace_back(value.text(0));
    value.reset();
    const auto first = static_cast<int>(3 + parameters.size());
    for (int k = 0; k < static_cast<int>(figures.size()); ++k) {
      const std::optional<double> figure = row.number(first + k);
      cells.emplace_back(figure ? platform::number_text(*figure) : std::string());
    }
    cells.emplace_back(row.text(2));
    text += base::csv_line(cells);
  }
  return text;
}

void SweepStore::write_front() {
  database_.run("DELETE FROM front");
  Statement insert(database_, "INSERT INTO front VALUES(?)");
  for (const SweepOutcome& o : pareto_front(outcomes()))
    insert.bind(1, std::int64_t{o.point}).run();
}

void SweepStore::number_figures() {
  database_.run(R"(
CREATE TEMP TABLE ranks AS
  SELECT figure, ROW_NUMBER() OVER (ORDER BY MIN(point * 1000000 + place)) AS rank
  FROM figure_values GROUP BY figure;
CREATE UNIQUE INDEX temp.by_figure ON ranks(figure))");
  const bool is_right =
      !Statement(database_, "SELECT 1 FROM temp.ranks WHERE rank <> figure").step();
  if (!is_right)  // by way of numbers that no figure has
    for (const char* rank :
         {"-(SELECT rank FROM temp.ranks r WHERE r.figure = t.figure)", "-figure"})
      for (const char* table : {"figures", "figure_values"})
        database_.run(fmt::format("UPDATE {} AS t SET figure = {}", table, rank));
  database_.run("DROP TABLE temp.ranks");
}

std::set<int> SweepStore::front() {
  std::set<int> points;
  Statement select(database_, "SELECT point FROM front");
  while (select.step()) points.insert(static_cast<int>(select.whole(0)));
  return points;
}

std::optional<std::string> SweepStore::publish(outputs::OutputFile& file) {
  Transaction transaction(database_);  // of several processes, the last sees what all have done
  number_figures();
  make_views(parameter_names(), figure_names());
  write_front();
  std::optional<std::string> elsewhere = file.publish(csv());
  transaction.commit();
  database_.rewrite();
  return elsewhere;
}

bool is_sweep(const fs::path& folder, bool may_be_empty) {
  Database database(folder / kSweepFile, Database::Mode::existing);
  const Schema schema = schema_of(database);
  return schema == Schema::of_sweep || (may_be_empty && schema == Schema::empty);
}

void empty_sweep(const fs::path& folder) {
  Database database(folder / kSweepFile, Database::Mode::existing);
  Transaction transaction(database);
  database.run(kSweepEmpty);
  transaction.commit();
}

}  // namespace leviosim::tools
