#include "tools/app/comparison/frame_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "tools/app/result/camera_figures.h"

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

/// Of the frames in the table.
struct Frames {
  std::vector<std::int64_t> latencies;  ///< of those that were processed
  double parallel = 0;                  ///< cycles, summed
  double single = 0;
  std::int64_t arrived = 0;
  std::int64_t dropped = 0;
  bool has_times = false;
};

Frames read_frames(const std::filesystem::path& file, const std::string& csv) {
  const std::vector<std::string> titles = titles_of(csv);
  const auto column = [&](const char* title) {
    return static_cast<std::size_t>(std::find(titles.begin(), titles.end(), title) -
                                    titles.begin());
  };
  const std::size_t latency = column("latency_ns");
  const std::size_t parallel = column("parallel_cycles");
  const std::size_t single = column("single_cycles");
  if (csv.empty() || csv.back() != '\n')
    throw InputError(fmt::format("{}: ends within a line: it was cut off", file.string()));
  base::CsvReader reader(file, base::Separator::comma, titles, csv);
  reader.next();  // the titles
  Frames frames;
  frames.has_times = std::max({latency, parallel, single}) < titles.size();
  while (const base::CsvRow* row = reader.next()) {
    ++frames.arrived;
    if (!frames.has_times) continue;
    if (row->text(latency).empty()) {
      ++frames.dropped;
      continue;
    }
    frames.latencies.push_back(row->nanoseconds(latency));
    frames.parallel += row->number(parallel);
    frames.single += row->number(single);
  }
  return frames;
}

}  // namespace

std::int64_t add_frame_statistics(const std::filesystem::path& file, const std::string& frames_csv,
                                  RunRecord& record) {
  Frames frames = read_frames(file, frames_csv);
  if (!frames.has_times || frames.arrived == 0) return frames.arrived;
  std::vector<std::int64_t>& sorted = frames.latencies;
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  const auto add = [&](const char* name, const char* unit, const char* description, double value) {
    record.statistics.push_back(
        {name, unit, description, sorted.empty() ? std::nullopt : std::optional<double>(value)});
  };
  const auto at = [&](double share) {
    return sorted.empty() ? 0 : static_cast<double>(percentile(sorted, share));
  };
  double sum = 0;
  for (const std::int64_t latency : sorted) sum += static_cast<double>(latency);
  add("frame.latency.mean", "ns", "from the camera's frame to its pose, all frames", sum / n);
  add("frame.latency.p50", "ns", "median from the camera's frame to its pose", at(0.5));
  add("frame.latency.p95", "ns", "that 95 % of the frames do not exceed", at(0.95));
  add("frame.latency.p99", "ns", "that 99 % of the frames do not exceed", at(0.99));
  add("frame.latency.worst", "ns", "longest from the camera's frame to its pose", at(1));
  add("frame.cycles.single.mean", "cycles", "of the front end on one core", frames.single / n);
  add("frame.cycles.parallel.mean", "cycles", "of the front end on N cores", frames.parallel / n);
  const double period = record.value("run.frame_period").value_or(0);
  const double rate = record.value("camera.rate").value_or(0);
  const double deadline = rate > 0 ? 1e9 / rate : period;
  const auto late = std::count_if(sorted.begin(), sorted.end(), [&](std::int64_t latency) {
    return static_cast<double>(latency) > deadline;
  });
  const double missed = record.value("camera.missed_share")
                            .value_or(static_cast<double>(frames.dropped + late) /
                                      static_cast<double>(frames.arrived));
  record.statistics.push_back(
      {"frame.missed_share", "1", "frames without a pose within a period of the camera", missed});
  return frames.arrived;
}

void add_operations(RunRecord& record) {
  for (const StageName& stage : record.stages) {
    const std::string ops = fmt::format("stages.{}.ops.", stage.key);
    std::optional<double> sum;
    for (const Statistic& s : record.statistics)
      if (s.value && s.name.rfind(ops, 0) == 0) sum = sum.value_or(0) + *s.value;
    if (sum)
      record.statistics.push_back({fmt::format("stages.{}.operations", stage.key), "1",
                                   "operations of all kinds, of all calls", sum});
  }
}

void add_memory_statistics(RunRecord& record) {
  std::optional<double> l1;
  for (const StageName& stage : record.stages) {
    const auto peak = record.value(fmt::format("stages.{}.memory.parallel", stage.key));
    if (!stage.on_controller && peak) l1 = std::max(l1.value_or(0), *peak);
  }
  std::optional<double> l2;
  for (const Statistic& s : record.statistics) {
    constexpr std::string_view kBytes = ".bytes";
    if (s.name.rfind("memory.l2.", 0) == 0 && s.value && s.name.size() > kBytes.size() &&
        s.name.compare(s.name.size() - kBytes.size(), kBytes.size(), kBytes) == 0)
      l2 = l2.value_or(0) + *s.value;
  }
  if (l1) record.statistics.push_back({"memory.l1.peak", "byte", "highest occupation of L1", l1});
  if (l2) record.statistics.push_back({"memory.l2.peak", "byte", "occupation of L2", l2});
}

}  // namespace leviosim::tools
