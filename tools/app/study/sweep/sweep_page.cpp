#include "tools/app/study/sweep/sweep_page.h"

#include "tools/app/study/sweep/sweep_report.h"

namespace leviosim::tools {
namespace {

/// "platform.cluster.clock" → "cluster.clock".
std::string title_of(const std::string& parameter) {
  constexpr std::string_view kPlatform = "platform.";
  return parameter.rfind(kPlatform, 0) == 0 ? parameter.substr(kPlatform.size()) : parameter;
}

}  // namespace

Json sweep_page(SweepStore& store) {
  constexpr double kNsToMs = 1e-6;
  const std::vector<std::string> parameters = store.parameter_names();
  StudyPage page;
  page.title = "A sweep";
  page.boxes = {sweep_box(store)};
  page.best = sweep_front(store);
  page.points = store.csv();
  page.columns = {{"point", "point", "", true}};
  for (const std::string& name : parameters)
    page.columns.push_back({name, title_of(name), "", true});
  const std::vector<StudyColumn> figures{
      {"objective.frame_time", "mean frame", "ms"},
      {"objective.energy", "energy per frame", "mJ"},
      {"objective.l1_peak", "L1 peak", "kB", false, false, 1e-3},
      {"objective.ate", "position error (ATE)", "m"},
      {"objective.area", "area", "mm2"},
      {"latency.all.p50", "median latency", "ms", false, false, kNsToMs},
      {"latency.all.p99", "latency of 99 %", "ms", false, false, kNsToMs},
      {"latency.all.worst", "worst latency", "ms", false, false, kNsToMs},
      {"camera.missed_share", "missed frames", "%", false, false, 100},
      {"energy.mean_power", "mean power", "mW"},
      {"energy.front_end_power", "power of the front end", "mW"},
      {"accuracy.completion", "completion", "%", false, true, 100},
      {"failure", "failure", ""}};
  page.columns.insert(page.columns.end(), figures.begin(), figures.end());
  if (!parameters.empty() && parameters.size() <= 2)
    page.curves = {parameters.front(),
                   parameters.size() == 2 ? parameters.back() : std::string(),
                   {"objective.frame_time", "objective.energy", "objective.l1_peak", "objective.ate",
                    "objective.area"}};
  page.x = "objective.frame_time";
  page.y = "objective.energy";
  page.colour = parameters.size() > 1 ? parameters.back() : std::string();
  return study_report(page);
}

}  // namespace leviosim::tools
