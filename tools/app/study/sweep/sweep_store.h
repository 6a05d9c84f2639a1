// Results of a sweep in one file of lines, points.jsonl: what the sweep is, then a point a line.
//
//   {"sweep":"leviosim sweep 4","points":2,"keys":"8f3c…","parameters":[…],"plan":"…",…}
//   {"point":1,"key":"41aa…","set":[[name, value],…],"record":{…}}     record/record.h
//
// A point is added as soon as it and those before it are finished, all or nothing: a process that
// dies leaves whole points only, and a last line that lacks its end does not count. Several
// processes may add to one file (sim/outputs/growing_file.h), and the lines of the parts of one
// sweep, one behind the other, are a sweep. A point may stand there twice, if both lines say the
// same. A table for people and data bases is sweep.csv, which follows from the lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim/base/opened_file.h"
#include "sim/outputs/output_file.h"
#include "tools/app/html_report/page.h"
#include "tools/app/study/sweep/point_run.h"
#include "tools/app/study/sweep/points.h"

namespace leviosim::tools {

inline constexpr const char* kSweepFile = "points.jsonl";
inline constexpr const char* kSweepCsv = "sweep.csv";
/// Of earlier versions, and not read any more.
inline constexpr const char* kOldSweepFile = "sweep.sqlite";
inline constexpr const char* kSweepFormat = "leviosim sweep 4";

/// A finished point as the report needs it.
struct SweepOutcome {
  int point = 0;
  std::string failure;  ///< empty if there are figures
  std::array<std::optional<double>, kObjectives.size()> objectives;
};

class SweepStore {
 public:
  /// Opens the file, or makes it for the points of a sweep, which outlive the store.
  /// @param plan  its text
  /// @throws InputError if it holds another sweep
  SweepStore(const std::filesystem::path& folder, const std::string& plan,
             const std::vector<SweepPoint>& points);
  /// Opens what is there. @throws InputError if it is no sweep's
  explicit SweepStore(const std::filesystem::path& folder);

  std::set<int> finished() const;
  void put(int point, const RunRecord& result);

  /// Takes over all that another has finished. @throws InputError if it is of another sweep, or if
  /// both have a point with different results
  void merge(const SweepStore& other);
  /// Makes a new file of the same sweep with nothing finished, if there is none.
  void copy_plan_to(const std::filesystem::path& folder) const;

  /// What is kept of a point; nothing of one that is not finished.
  std::optional<RunRecord> result_of(int point) const;
  /// In the order of their numbers.
  std::vector<SweepOutcome> outcomes() const;
  /// That the points set, in the order of the plan.
  const std::vector<std::string>& parameter_names() const { return about_.parameters; }
  using Settings = std::vector<std::pair<std::string, std::string>>;
  /// Names and values of a finished point; empty of one that is not.
  const Settings& settings(int point) const;
  /// "platform.cluster.clock=240MHz" of a finished point.
  std::string settings_of(int point) const;
  std::int64_t planned() const { return about_.points; }
  /// Whether these are the points of the sweep, by their keys.
  bool holds(const std::vector<SweepPoint>& points) const;

  /// Remembers where the plan lies, since what it names lies beside it.
  void keep_place(const std::filesystem::path& plan);
  /// That file, which may be gone; nothing if none was remembered.
  std::optional<std::filesystem::path> place() const;
  const std::string& plan_text() const { return about_.plan; }
  /// Digest of the sources of the program that made the file.
  const std::string& simulator() const { return about_.simulator; }

  /// Brings sweep.csv up to date: a row per finished point, a column per parameter and figure. It
  /// does not depend on which point was finished first.
  /// @returns nothing, or why sweep.csv has another name now
  [[nodiscard]] std::optional<std::string> publish(outputs::OutputFile& file);
  /// The text of sweep.csv.
  std::string csv() const;

 private:
  /// The first line, and later ones that say where the plan lies by now.
  struct About {
    std::int64_t points = 0;
    std::string keys;  ///< a digest of those of all points, in their order
    std::string simulator;
    std::string program;
    std::string plan;
    std::string place;  ///< of its file, relative to the folder; empty if it is not known
    std::vector<std::string> parameters;
  };
  /// A finished point. Names of figures are kept once for all points.
  struct Kept {
    std::string line;  ///< with its end
    Settings settings;
    std::string failure;
    std::vector<std::pair<std::size_t, double>> figures;  ///< place in figure_names_, value
  };

  static std::string line_of(const About& about);
  std::string line_of(int point, const RunRecord& result) const;
  void load(base::OpenedFile file);
  void add_line(std::string_view line, std::uint64_t begin);
  void add_about(const Json& line);
  void add_point(const Json& line, std::string_view text);
  std::size_t figure(const std::string& name, const std::string& unit);
  /// Adds what `lines` says once all that is in the file is known; then knows that, too.
  void append(const std::function<std::string()>& lines);

  std::filesystem::path folder_;
  std::filesystem::path file_;
  const std::vector<SweepPoint>* planned_points_ = nullptr;
  About about_;
  std::string first_line_;
  std::uint64_t read_to_ = 0;  ///< of the file [bytes]
  std::map<int, Kept> points_;
  std::vector<std::pair<std::string, std::string>> figure_names_;  ///< with units
  std::unordered_map<std::string, std::size_t> figure_places_;
};

/// Whether a folder's file of points is a sweep's, of whatever version.
bool is_sweep(const std::filesystem::path& folder);
/// @throws InputError if the folder holds a sweep of an earlier version only, saying what to do
void refuse_old_sweep(const std::filesystem::path& folder);

}  // namespace leviosim::tools
