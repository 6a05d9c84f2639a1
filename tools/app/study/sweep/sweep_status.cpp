#include "tools/app/study/sweep/sweep_status.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

/// The folder itself, or those in it that hold sweeps, in the order of their names.
std::vector<fs::path> sweeps_in(const fs::path& folder) {
  std::error_code none;  // what cannot be read holds no sweep
  if (folder.empty() || !fs::is_directory(folder, none)) return {};
  const auto holds_sweep = [](const fs::path& at) { return base::is_file(at / kSweepFile); };
  if (holds_sweep(folder)) return {folder};
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
    if (holds_sweep(entry.path())) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// "0.2 s", "3 min", "5 h": two digits.
std::string rough_time(double seconds) {
  if (seconds < 90) return fmt::format("{:.2g} s", seconds);
  if (seconds < 90 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::int64_t SweepStatus::shares(double task_seconds) const {
  const double all = seconds_a_point.value_or(0) * static_cast<double>(open());
  return std::max<std::int64_t>(1, std::llround(std::ceil(all / task_seconds)));
}

SweepStatus sweep_status(const fs::path& folder, const std::vector<SweepPoint>& points,
                         const std::function<void(std::size_t point)>& time) {
  std::map<int, bool> failed;  // of each that is done
  for (const fs::path& sweep : sweeps_in(folder)) {
    const SweepStore store(sweep);
    if (!store.holds(points))
      throw InputError(
          fmt::format("{}: holds another sweep; expected one of this plan", sweep.string()));
    for (const SweepOutcome& outcome : store.outcomes())
      failed.emplace(outcome.point, !outcome.failure.empty());
  }
  SweepStatus status;
  status.points = static_cast<std::int64_t>(points.size());
  status.done = static_cast<std::int64_t>(failed.size());
  status.failed =
      std::count_if(failed.begin(), failed.end(), [](const auto& p) { return p.second; });
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (failed.count(static_cast<int>(i) + 1) > 0) continue;
    time(i);  // which reads what all points need
    const auto begin = std::chrono::steady_clock::now();
    time(i);
    status.seconds_a_point =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    break;
  }
  return status;
}

void SweepEstimate::take(double seconds) {
  constexpr std::size_t kFew = 10;
  const std::lock_guard<std::mutex> lock(mutex_);
  least_s_ = taken_ == 0 ? seconds : std::min(least_s_, seconds);
  if (++taken_ != 2 || points_ < kFew || style_ == ProgressLine::Style::None) return;
  const unsigned cores =
      threads_ > 0 ? threads_ : std::max(1u, std::thread::hardware_concurrency());
  const char* const clear = style_ == ProgressLine::Style::Rewritten ? "\r\x1b[K" : "";
  const std::string text = fmt::format(
      "{}{} points, {} each: about {} on {} core{}\n", clear, points_, rough_time(least_s_),
      rough_time(least_s_ * static_cast<double>(points_) / cores), cores, cores == 1 ? "" : "s");
  std::fputs(text.c_str(), stderr);
}

std::string status_text(const SweepStatus& status, const std::string& plan, double task_seconds) {
  std::string text = fmt::format("in short: {} of {} points are done", status.done, status.points);
  if (status.failed > 0) text += fmt::format(" ({} cannot run)", status.failed);
  if (!status.seconds_a_point) return text + '\n';
  const double all = *status.seconds_a_point * static_cast<double>(status.open());
  text += fmt::format("; the other {} take {} on one core as fast as here, {} each\n",
                      status.open(), rough_time(all), rough_time(*status.seconds_a_point));
  const std::int64_t shares = status.shares(task_seconds);
  if (shares > 1)
    text +=
        fmt::format("tasks of {}: {} shares, the first: leviosim sweep {} --shard 1/{} --jobs 1\n",
                    rough_time(task_seconds), shares, shell_word(plan), shares);
  else
    text += fmt::format("one task of {} is enough for them\n", rough_time(task_seconds));
  return text;
}

Json status_json(const SweepStatus& status, double task_seconds) {
  return {{"format", "leviosim sweep status"},
          {"version", 1},
          {"points", status.points},
          {"done", status.done},
          {"failed", status.failed},
          {"open", status.open()},
          {"seconds_a_point", value_of(status.seconds_a_point)},
          {"shares", status.shares(task_seconds)}};
}

}  // namespace leviosim::tools
