#include "tools/app/study/sweep/sweep_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/pieces.h"
#include "sim/base/sha256.h"
#include "sim/outputs/growing_file.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/json_reader.h"
#include "tools/app/study/sweep/sweep_key.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kAboutBegin = "{\"sweep\":\"leviosim sweep ";
/// Publishing a table of a million points takes some seconds under the lock.
constexpr std::chrono::seconds kPatience{60};
constexpr JsonLimits kLineLimits{.bytes = std::size_t{4} << 20, .depth = 8, .values = 100'000};

fs::path made(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw InputError(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
  return folder / kSweepFile;
}

fs::path existing(const fs::path& folder) {
  refuse_old_sweep(folder);
  if (!base::is_file(folder / kSweepFile))
    throw InputError(fmt::format("{}: holds no {}; expected the folder of a sweep", folder.string(),
                                 kSweepFile));
  return folder / kSweepFile;
}

std::string digest_of_keys(const std::vector<SweepPoint>& points) {
  base::Sha256 all;
  for (const SweepPoint& point : points) {
    throw_if_interrupted();
    all.add(point.key + '\n');
  }
  return all.hex();
}

/// Relative, so that a sweep and its plan can be moved together.
std::string place_of(const fs::path& plan, const fs::path& folder) {
  return fs::proximate(plan, folder).string();
}

std::string string_of(const Json& json) { return json.get<std::string>(); }

}  // namespace

SweepStore::SweepStore(const fs::path& folder, const std::string& plan,
                       const std::vector<SweepPoint>& points)
    : folder_(folder), file_(made(folder)), planned_points_(&points) {
  refuse_old_sweep(folder);
  about_.points = static_cast<std::int64_t>(points.size());
  about_.keys = digest_of_keys(points);
  about_.simulator = results_version();
  about_.program = fmt::format("leviosim {} {}", version(), revision());
  about_.plan = plan;
  if (!points.empty())
    for (const PointParameter& parameter : points.front().parameters)
      about_.parameters.push_back(parameter.name);
  append([] { return std::string(); });
}

SweepStore::SweepStore(const fs::path& folder) : folder_(folder), file_(existing(folder)) {
  load(base::OpenedFile(file_, base::InputKind::points));
}

std::string SweepStore::line_of(const About& about) {
  Json line;
  line["sweep"] = kSweepFormat;
  line["points"] = about.points;
  line["keys"] = about.keys;
  line["simulator"] = about.simulator;
  line["program"] = about.program;
  line["parameters"] = about.parameters;
  line["place"] = about.place;
  line["plan"] = about.plan;
  return json_text(line) + '\n';
}

std::string SweepStore::line_of(int point, const RunRecord& result) const {
  const SweepPoint& planned = (*planned_points_)[static_cast<std::size_t>(point) - 1];
  Json line;
  line["point"] = point;
  line["key"] = planned.key;
  line["set"] = Json::array();
  for (const PointParameter& parameter : planned.parameters)
    line["set"].push_back({parameter.name, parameter.text});
  line["record"] = record_json(result);
  return json_text(line) + '\n';
}

/// Reads on where it ended, or anew where another process began anew.
void SweepStore::load(base::OpenedFile file) {
  base::Pieces text(std::move(file));
  const bool goes_on = read_to_ > 0 && text.size() >= read_to_ &&
                       text.at(0, first_line_.size()) == first_line_ &&
                       text.at(read_to_ - 1, 1) == "\n";
  if (!goes_on) read_to_ = 0;
  while (read_to_ < text.size()) {
    const std::string_view line = text.line_at(read_to_, kLineLimits.bytes);
    const std::uint64_t end = read_to_ + line.size();
    if (end == text.size()) break;  // it lacks its end
    if (!line.empty()) add_line(line, read_to_);
    read_to_ = end + 1;
  }
  if (read_to_ == 0)
    throw InputError(fmt::format("{}: is no file of leviosim sweep", file_.string()));
}

void SweepStore::add_line(std::string_view text, std::uint64_t begin) {
  if (begin == 0 && !text.starts_with(kAboutBegin))
    throw InputError(fmt::format("{}: is no file of leviosim sweep", file_.string()));
  const std::string where = fmt::format("{}: line at byte {}", file_.string(), begin);
  const Json line = read_json(where, text, kLineLimits);
  try {
    if (text.starts_with(kAboutBegin))
      add_about(line);
    else
      add_point(line, text);
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: expected a line that 'leviosim sweep' writes", where));
  }
  if (begin == 0) first_line_ = std::string(text) + '\n';
}

void SweepStore::add_about(const Json& line) {
  if (string_of(line.at("sweep")) != kSweepFormat)
    throw InputError(fmt::format("{}: is of a version that is not known; expected '{}'",
                                 file_.string(), kSweepFormat));
  About about{.points = line.at("points").get<std::int64_t>(),
              .keys = string_of(line.at("keys")),
              .simulator = string_of(line.at("simulator")),
              .program = string_of(line.at("program")),
              .plan = string_of(line.at("plan")),
              .place = string_of(line.at("place")),
              .parameters = line.at("parameters").get<std::vector<std::string>>()};
  if (about.points < 0 || about.points > static_cast<std::int64_t>(kMostPoints))
    throw InputError(fmt::format("{}: has {} points; expected at most {}", file_.string(),
                                 about.points, kMostPoints));
  if (!about_.keys.empty() && (about.keys != about_.keys || about.points != about_.points))
    throw InputError(fmt::format(
        "{}: holds the results of another plan, of other data or of another leviosim; choose a new "
        "folder, or --force to begin anew (finished points come from the cache where they are "
        "the same)",
        file_.string()));
  about_ = std::move(about);
}

void SweepStore::add_point(const Json& line, std::string_view text) {
  const auto number = line.at("point").get<std::int64_t>();
  if (number < 1 || number > about_.points)
    throw InputError(
        fmt::format("{}: has a point {}; expected 1 to {}", file_.string(), number, about_.points));
  const int point = static_cast<int>(number);
  Kept kept{.line = std::string(text) + '\n', .settings = {}, .failure = {}, .figures = {}};
  const auto known = points_.find(point);
  if (known != points_.end()) {
    if (known->second.line == kept.line) return;
    throw InputError(
        fmt::format("{}: has other results for point {} than it has before; expected lines of one "
                    "program",
                    file_.string(), point));
  }
  if (string_of(line.at("key")).empty()) throw InputError(file_.string() + ": a point has no key");
  for (const Json& set : line.at("set"))
    kept.settings.emplace_back(string_of(set.at(0)), string_of(set.at(1)));
  if (kept.settings.size() != about_.parameters.size())
    throw InputError(fmt::format("{}: point {} sets {} parameters; expected {}", file_.string(),
                                 point, kept.settings.size(), about_.parameters.size()));
  const RunRecord record = record_of_json(file_.string(), line.at("record"), Level::figures);
  kept.failure = record.failure;
  for (const Statistic& s : record.statistics)
    if (s.value) kept.figures.emplace_back(figure(s.name, s.unit), *s.value);
  points_.emplace(point, std::move(kept));
}

std::size_t SweepStore::figure(const std::string& name, const std::string& unit) {
  const auto [place, is_new] = figure_places_.try_emplace(name, figure_names_.size());
  if (is_new) figure_names_.emplace_back(name, unit);
  return place->second;
}

void SweepStore::append(const std::function<std::string()>& lines) {
  const auto addition = [&](std::optional<base::OpenedFile> there) {
    outputs::Addition wanted;
    if (there) {
      load(std::move(*there));
      wanted.whole = read_to_;
    } else {
      read_to_ = 0;
      points_.clear();
      wanted.lines = line_of(about_);
    }
    wanted.lines += lines();
    return wanted;
  };
  outputs::add_lines(file_, base::InputKind::points, kPatience, addition);
  load(base::OpenedFile(file_, base::InputKind::points));
}

void SweepStore::keep_place(const fs::path& plan) {
  if (place() == fs::weakly_canonical(plan)) return;
  append([&] {
    About about = about_;
    about.place = place_of(plan, folder_);
    return line_of(about);
  });
}

std::optional<fs::path> SweepStore::place() const {
  if (about_.place.empty()) return std::nullopt;
  return fs::weakly_canonical(folder_ / about_.place);
}

bool SweepStore::holds(const std::vector<SweepPoint>& points) const {
  return planned() == static_cast<std::int64_t>(points.size()) &&
         about_.keys == digest_of_keys(points);
}

std::set<int> SweepStore::finished() const {
  std::set<int> numbers;
  for (const auto& [point, kept] : points_) numbers.insert(point);
  return numbers;
}

void SweepStore::put(int point, const RunRecord& result) {
  append([&] { return points_.count(point) > 0 ? std::string() : line_of(point, result); });
}

std::optional<RunRecord> SweepStore::result_of(int point) const {
  const auto kept = points_.find(point);
  if (kept == points_.end()) return std::nullopt;
  RunRecord record;
  record.failure = kept->second.failure;
  for (const auto& [place, value] : kept->second.figures)
    record.statistics.push_back(
        {.name = figure_names_[place].first, .unit = figure_names_[place].second, .value = value});
  return record;
}

void SweepStore::merge(const SweepStore& other) {
  if (about_.keys != other.about_.keys)
    throw InputError(fmt::format("{}: is of another plan, other data or another leviosim than {}",
                                 other.file_.string(), file_.string()));
  append([&] {
    std::string lines;
    for (const auto& [point, theirs] : other.points_) {
      throw_if_interrupted();
      const auto ours = points_.find(point);
      if (ours == points_.end())
        lines += theirs.line;
      else if (ours->second.line != theirs.line)
        throw InputError(fmt::format("{}: has other results for point {} than {}",
                                     other.file_.string(), point, file_.string()));
    }
    return lines;
  });
}

void SweepStore::copy_plan_to(const fs::path& folder) const {
  About about = about_;
  if (const auto plan = place()) about.place = place_of(*plan, folder);
  outputs::add_lines(made(folder), base::InputKind::points, kPatience,
                     [&](const std::optional<base::OpenedFile>& there) {
                       return outputs::Addition{0, there ? std::string() : line_of(about)};
                     });
}

std::vector<SweepOutcome> SweepStore::outcomes() const {
  std::array<std::size_t, kObjectives.size()> places{};
  for (std::size_t k = 0; k < kObjectives.size(); ++k) {
    const auto place = figure_places_.find(kObjectives[k].statistic);
    places[k] = place == figure_places_.end() ? figure_names_.size() : place->second;
  }
  std::vector<SweepOutcome> all;
  for (const auto& [point, kept] : points_) {
    SweepOutcome& outcome = all.emplace_back();
    outcome.point = point;
    outcome.failure = kept.failure;
    for (const auto& [place, value] : kept.figures)
      for (std::size_t k = 0; k < kObjectives.size(); ++k)
        if (places[k] == place) outcome.objectives[k] = value * kObjectives[k].factor;
  }
  return all;
}

const SweepStore::Settings& SweepStore::settings(int point) const {
  static const Settings kNone;
  const auto kept = points_.find(point);
  return kept == points_.end() ? kNone : kept->second.settings;
}

std::string SweepStore::settings_of(int point) const {
  std::string text;
  for (const auto& [name, value] : settings(point))
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, without_count_unit(value));
  return text;
}

std::string SweepStore::csv() const {
  std::vector<std::size_t> order(figure_names_.size());  // of figures, by name
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return figure_names_[a].first < figure_names_[b].first;
  });
  std::vector<std::string> cells{"point", "status"};
  cells.insert(cells.end(), about_.parameters.begin(), about_.parameters.end());
  for (const Objective& o : kObjectives) cells.emplace_back(o.figure);
  for (const std::size_t place : order) cells.push_back(figure_names_[place].first);
  cells.emplace_back("failure");
  std::string text = csv_line(cells);
  const std::vector<SweepOutcome> all = outcomes();
  auto outcome = all.begin();
  for (const auto& [point, kept] : points_) {
    throw_if_interrupted();
    cells = {std::to_string(point), kept.failure.empty() ? "done" : "failed"};
    for (const auto& [name, value] : kept.settings) cells.emplace_back(value);
    for (const std::optional<double>& value : (outcome++)->objectives)
      cells.push_back(value ? platform::number_text(*value) : "");
    std::vector<std::string> values(figure_names_.size());
    for (const auto& [place, value] : kept.figures) values[place] = platform::number_text(value);
    for (const std::size_t place : order) cells.push_back(std::move(values[place]));
    cells.emplace_back(kept.failure);
    text += csv_line(cells);
  }
  return text;
}

std::optional<std::string> SweepStore::publish(outputs::OutputFile& file) {
  // Of several processes, the last one to publish sees what all have done.
  std::optional<std::string> elsewhere;
  outputs::add_lines(file_, base::InputKind::points, kPatience,
                     [&](std::optional<base::OpenedFile> there) {
                       if (there) load(std::move(*there));
                       elsewhere = file.publish(csv());
                       return outputs::Addition{};
                     });
  return elsewhere;
}

bool is_sweep(const fs::path& folder) {
  const base::OpenedFile file(folder / kSweepFile, base::InputKind::points);
  if (file.size() < kAboutBegin.size()) return false;
  std::string begin(kAboutBegin.size(), '\0');
  file.read_piece(0, begin);
  return begin == kAboutBegin;
}

void refuse_old_sweep(const fs::path& folder) {
  if (base::exists(folder / kOldSweepFile) && !base::exists(folder / kSweepFile))
    throw InputError(
        fmt::format("{}: holds {} of an earlier leviosim, which is not read any more; run the "
                    "sweep again in a new folder: leviosim sweep PLAN --out DIR",
                    folder.string(), kOldSweepFile));
}

}  // namespace leviosim::tools
