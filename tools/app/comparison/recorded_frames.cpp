#include "tools/app/comparison/recorded_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"

namespace leviosim::tools {
namespace {

std::vector<std::string> titles_of(const std::string& csv) {
  std::vector<std::string> titles(1);
  for (const char c : csv.substr(0, csv.find('\n'))) {
    if (c == ',')
      titles.emplace_back();
    else if (c != '\r')
      titles.back() += c;
  }
  return titles;
}

/// A CSV file whose first row holds the titles of its columns.
class Table {
 public:
  Table(const std::filesystem::path& file, const std::string& csv)
      : titles_(titles_of(csv)), reader_(file, base::Separator::comma, titles_, csv) {
    if (csv.empty() || csv.back() != '\n')
      throw InputError(fmt::format("{}: ends within a line: it was cut off", file.string()));
    reader_.next();  // the titles
  }

  /// Absent if there is none of that title.
  std::optional<std::size_t> column(std::string_view title) const {
    const auto it = std::find(titles_.begin(), titles_.end(), title);
    if (it == titles_.end()) return std::nullopt;
    return static_cast<std::size_t>(it - titles_.begin());
  }
  const base::CsvRow* next() { return reader_.next(); }

 private:
  std::vector<std::string> titles_;
  base::CsvReader reader_;
};

/// The columns of frames.csv that are read.
struct Columns {
  explicit Columns(const Table& table)
      : t_ns(table.column("t_ns")),
        source(table.column("source")),
        restarts(table.column("map_restarts")),
        health(table.column("health")),
        latency(table.column("latency_ns")),
        start(table.column("start_ns")),
        end(table.column("end_ns")),
        parallel(table.column("parallel_cycles")),
        single(table.column("single_cycles")) {}

  bool are_timed() const { return latency && parallel && single; }

  std::optional<std::size_t> t_ns, source, restarts, health, latency, start, end, parallel, single;
};

int whole(const base::CsvRow& row, std::size_t column) {
  constexpr double kMost = 1e9;
  const double value = row.number(column);
  if (!(value >= 0 && value <= kMost && value == std::floor(value)))
    row.fail(column, "no whole number");
  return static_cast<int>(value);
}

RecordedFrame::Timing timing_of(const base::CsvRow& row, const Columns& at) {
  RecordedFrame::Timing timing;
  timing.latency_ns = timing.own_ns = row.nanoseconds(*at.latency);
  if (at.start && at.end) timing.own_ns = row.nanoseconds(*at.end) - row.nanoseconds(*at.start);
  timing.parallel_cycles = row.number(*at.parallel);
  timing.single_cycles = row.number(*at.single);
  return timing;
}

/// Of a frame that was not dropped.
void read_result(const base::CsvRow& row, const Columns& at, RecordedFrame& frame) {
  if (at.source)
    for (const vio::PoseSourceInfo& info : vio::kPoseSources)
      if (info.name == row.text(*at.source)) frame.source = info.source;
  if (at.restarts) frame.map_restarts = whole(row, *at.restarts);
  if (at.health) frame.health = whole(row, *at.health);
  if (at.are_timed()) frame.timing = timing_of(row, at);
}

}  // namespace

std::vector<RecordedFrame> read_frames(const std::filesystem::path& file, const std::string& csv) {
  Table table(file, csv);
  const Columns at(table);
  std::vector<RecordedFrame> frames;
  while (const base::CsvRow* row = table.next()) {
    RecordedFrame& frame = frames.emplace_back();
    if (at.t_ns) frame.t_ns = row->nanoseconds(*at.t_ns);
    frame.dropped = at.are_timed() && row->text(*at.latency).empty();
    if (!frame.dropped) read_result(*row, at, frame);
  }
  return frames;
}

std::vector<PositionPair> read_positions(const std::filesystem::path& file,
                                         const std::string& csv) {
  Table table(file, csv);
  std::vector<std::size_t> columns;
  for (const char* of : {"estimate", "truth"})
    for (const char axis : {'x', 'y', 'z'})
      if (const auto column = table.column(fmt::format("{}_{}_m", of, axis)))
        columns.push_back(*column);
  std::vector<PositionPair> pairs;
  constexpr std::size_t kCoordinates = 6;
  if (columns.size() < kCoordinates) return pairs;
  while (const base::CsvRow* row = table.next()) {
    PositionPair& pair = pairs.emplace_back();
    for (std::size_t i = 0; i < kCoordinates; ++i)
      (i < 3 ? pair.first : pair.second)[static_cast<Eigen::Index>(i % 3)] =
          row->number(columns[i]);
  }
  return pairs;
}

}  // namespace leviosim::tools
