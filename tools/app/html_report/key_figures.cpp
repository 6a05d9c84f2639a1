#include "tools/app/html_report/key_figures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "tools/app/result/summary.h"
#include "tools/app/table/cell.h"

namespace leviosim::tools {

namespace {

std::string ms(double ns) { return fmt::format("{:.4g} ms", ns * 1e-6); }

/// "; between 48.1 and 62.0 ms"; empty without a band.
std::string between(const RunRecord& run, const std::string& name) {
  const auto low = run.value(name + ".low");
  const auto high = run.value(name + ".high");
  if (!low || !high) return {};
  return fmt::format("; between {:.1f} and {:.1f} ms", *low * 1e-6, *high * 1e-6);
}

void add_time(std::vector<KeyFigure>& list, const RunRecord& run) {
  const auto worst = run.value("frame.time.worst");
  const auto mean = run.value("frame.time.mean");
  const auto p99 = run.value("frame.time.p99");
  if (!worst || !mean || !p99) return;
  const double deadline = deadline_ns(run);
  list.push_back(
      {"Frame time, worst", fmt::format("{:.2f}", *worst * 1e-6), "ms",
       fmt::format("a frame's own work; deadline {}; mean {:.2f}, 99 % within {:.2f} ms{}",
                   ms(deadline), *mean * 1e-6, *p99 * 1e-6, between(run, "frame.time.worst")),
       *worst / deadline});
  const auto latency = run.value("frame.latency.worst");
  constexpr double kWaited_ns = 1e4;
  if (latency && (run.value("camera.arrived") || *latency > *worst + kWaited_ns))
    list.push_back({"Latency, worst", fmt::format("{:.2f}", *latency * 1e-6), "ms",
                    "from the camera's frame to its pose, with waiting", *latency / deadline});
}

std::string capital(std::string_view text) {
  std::string word(text);
  if (!word.empty() && word[0] >= 'a' && word[0] <= 'z')
    word[0] = static_cast<char>(word[0] - 'a' + 'A');
  return word;
}

void add_figure_rows(std::vector<KeyFigure>& list, const RunRecord& run) {
  for (const FigureRow& row : figure_rows())
    if (const auto value = row.of ? run.value(row.statistic) : std::nullopt)
      list.push_back({capital(row.title), fmt::format("{:.3g}", *value * row.scale),
                      std::string(row.title_unit), std::string(row.meaning)});
}

void add_speedup(std::vector<KeyFigure>& list, const RunRecord& run) {
  const auto single = run.value("frame.cycles.single.mean");
  const auto parallel = run.value("frame.cycles.parallel.mean");
  if (!single || !parallel || *parallel == 0) return;
  list.push_back(
      {"Speed-up", fmt::format("{:.2f}", *single / *parallel), "×",
       fmt::format("{} over one; a mean frame takes {:.2f} Mcycles instead of {:.1f}",
                   run.facts.cores == 1 ? "1 core" : fmt::format("{} cores", run.facts.cores),
                   *parallel * 1e-6, *single * 1e-6)});
}

/// The highest occupation of a memory and who occupies it.
void add_memory(std::vector<KeyFigure>& list, const RunRecord& run) {
  for (const auto& [name, key] : {std::pair{"L1", "l1"}, {"L2", "l2"}}) {
    const auto used = run.value(fmt::format("memory.{}.peak", key));
    const auto size = run.value(fmt::format("run.{}_size", key));
    if (!used || !size || *size <= 0) continue;
    const StageName* owner = name == std::string_view("L1") ? fullest_stage(run) : nullptr;
    list.push_back(
        {fmt::format("{} peak", name), fmt::format("{:.1f}", *used * 1e-3), "kB",
         fmt::format("of {:.1f} kB{}", *size * 1e-3, owner == nullptr ? "" : ", in " + owner->name),
         *used / *size});
  }
}

void add_energy(std::vector<KeyFigure>& list, const RunRecord& run) {
  const auto energy = run.value("energy.frame");
  const auto low = run.value("energy.frame.low");
  const auto high = run.value("energy.frame.high");
  if (!energy || !low || !high) return;
  KeyFigure figure{"Energy per frame", fmt::format("{:.3f}", *energy), "mJ",
                   fmt::format("between {:.2f} and {:.2f} mJ", *low, *high)};
  if (const auto power = run.value("energy.mean_power"))
    figure.note += fmt::format("; {:.1f} mW on average, idle time included", *power);
  list.push_back(std::move(figure));
}

}  // namespace

std::string reason_of(const WorstFrame& worst) {
  if (worst.stage.empty()) return {};
  const std::string waited =
      worst.waited_ns > 0
          ? fmt::format(" of its own, after {} of waiting for the front end", ms(worst.waited_ns))
          : "";
  return fmt::format("The slowest frame, number {}, spends {} in {}, of {}{}.", worst.frame,
                     ms(worst.stage_ns), worst.stage, ms(worst.latency_ns - worst.waited_ns),
                     waited);
}

std::vector<KeyFigure> key_figures(const RunRecord& run, const std::string& protocol) {
  std::vector<KeyFigure> list;
  add_time(list, run);
  add_figure_rows(list, run);
  add_speedup(list, run);
  add_memory(list, run);
  add_energy(list, run);
  const auto error = run.value("accuracy.ate.rmse");
  if (error && !protocol.empty())
    list.push_back({"Position error (ATE)", metres_text(*error, 3), "m RMSE", protocol, {}});
  return list;
}

}  // namespace leviosim::tools
