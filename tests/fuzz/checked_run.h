// A small run made by hand, for fuzz targets that hold it against limits.
#pragma once

#include <cstdlib>

#include "tools/app/budget/check.h"
#include "tools/app/budget/check_for_ci.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/record/record.h"

namespace leviosim::fuzz {

/// Two stages, one of them on the controller, with what phrases of limits are mostly about.
inline tools::RunRecord checked_run() {
  tools::RunRecord run;
  run.name = "run";
  run.facts.profile = "levio";
  run.facts.platform = "gap9";
  run.facts.cores = 8;
  run.facts.image_width = 160;
  run.facts.image_height = 120;
  run.facts.frames = 10;
  run.stages = {{"feature extraction", "feature_extraction", false},
                {"optimiser update", "optimiser_update", true}};
  const auto add = [&](const std::string& name, const char* unit, double value) {
    run.statistics.push_back({name, unit, "", value});
  };
  add("frames.count", "1", 10);
  add("frame.latency.p99", "ns", 40e6);
  add("frame.missed_share", "1", 0.1);
  add("frame.cycles.parallel.mean", "cycles", 3e6);
  add("memory.l1.peak", "byte", 64'000);
  add("accuracy.ate.rmse", "m", 0.2);
  run.statistics.push_back({"accuracy.completion", "1", "", std::nullopt});
  for (const tools::StageName& stage : run.stages) {
    const std::string path = "stages." + stage.key + '.';
    add(path + "calls", "1", 10);
    add(path + "operations", "1", 1e6);
    add(path + "cycles.single.mean", "cycles", 1e6);
    add(path + "cycles.parallel.mean", "cycles", 2e5);
    add(path + "memory.parallel", "byte", 64'000);
    add(path + "memory.block.image", "byte", 19'200);
    add("energy." + stage.key + ".call", "uJ", 12);
    run.cycles.push_back({stage.name,
                          stage.on_controller,
                          2e6,
                          {{"detect", "issue", "int_alu", 1.5e6, 1e6}, {"", "fpu", "", 5e5, 0}}});
  }
  return run;
}

/// Everything that a check may print. Another number of entries than of limits that are not met is
/// a fault.
inline void report(const tools::CheckResult& result) {
  tools::check_printout(result, {});
  tools::check_json(result);
  tools::junit_xml(result);
  tools::github_annotations(result);
  const auto document = tools::Json::parse(tools::gitlab_report(result), nullptr, false);
  if (document.size() != result.missed() + result.warned()) std::abort();
}

}  // namespace leviosim::fuzz
