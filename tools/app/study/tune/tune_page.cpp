#include "tools/app/study/tune/tune_page.h"

#include <fmt/format.h>

#include "tools/app/study/tune/tune_report.h"

namespace leviosim::tools {

Json tune_page(const TunePlan& plan, const std::vector<TunePoint>& points,
               const std::vector<Choice>& choices) {
  constexpr double kNsToMs = 1e-6;
  StudyPage page;
  page.title = fmt::format("Clocks for {} on {}", plan.request.profile, plan.options.platform);
  page.boxes = choice_boxes(plan, choices);
  page.summary = tune_notes(plan);
  page.points = tune_csv(plan, points);
  page.columns = {{"fps", "frame rate", "frames/s", true},
                  {"clock_mhz", "clock", "MHz", true},
                  {"voltage", "supply", "V", true},
                  {"variation", "variation", "", true},
                  {"missed_share", "missed frames", "%", false, false, 100},
                  {"latency_p50_ns", "median latency", "ms", false, false, kNsToMs},
                  {"latency_p99_ns", "latency of 99 %", "ms", false, false, kNsToMs},
                  {"latency_worst_ns", "worst latency", "ms", false, false, kNsToMs},
                  {"power_mw", "power", "mW"},
                  {"frame_mj", "energy per frame", "mJ"},
                  {"ate_rmse_m", "position error (ATE)", "m"},
                  {"completion", "completion", "%", false, true, 100},
                  {"failure", "failure", ""}};
  page.curves = {"clock_mhz", "fps", {"missed_share", "ate_rmse_m", "power_mw", "latency_p99_ns"}};
  page.limits = {{"missed_share", 100 * plan.miss_rate}, {"ate_rmse_m", plan.ate_m}};
  page.x = "power_mw";
  page.y = "ate_rmse_m";
  page.colour = "fps";
  return study_report(page);
}

}  // namespace leviosim::tools
