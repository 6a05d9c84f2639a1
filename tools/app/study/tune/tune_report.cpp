#include "tools/app/study/tune/tune_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/app/cli/host.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/finished_runs.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tuning.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr double kNsToMs = 1e-6;

std::string percent(double share) { return fmt::format("{:.1f}", 100 * share); }

/// Of nanoseconds.
std::string ms(double ns) { return fmt::format("{:.1f}", ns * 1e-6); }

std::string milli(const std::optional<Banded>& figure, int decimals) {
  return figure ? fmt::format("{:.{}f}", figure->value * 1e3, decimals) : kNothing;
}

std::string milli_band(const std::optional<Banded>& figure) {
  return figure ? fmt::format("{:.1f}–{:.1f}", figure->low * 1e3, figure->high * 1e3) : kNothing;
}

std::string volts(const ClockSetting& setting) {
  return setting.voltage ? fmt::format("{:.2f}", setting.voltage->count()) : kNothing;
}

/// "240 MHz and 0.65 V".
std::string clock_text(const ClockSetting& setting) {
  std::string text = fmt::format("{:g} MHz", megahertz(setting.clock));
  return setting.voltage ? text + fmt::format(", {:g} V", setting.voltage->count()) : text;
}

/// "300 MHz (6.0 %, 0.100)".
std::string short_text(const TunePoint& point) {
  return fmt::format("{:g} MHz ({} %, {})", megahertz(point.setting.clock),
                     percent(point.miss_rate()), error_text(point.ate().median, 3));
}

std::string point_text(const TunePoint& point) {
  const std::optional<double> error = point.ate().median;
  std::string text = fmt::format("{} % missed, ATE {}", percent(point.miss_rate()),
                                 error ? metres(*error, 3) : kDiverged);
  if (const auto power = point.median(&LoopOutcome::power_w))
    text += fmt::format(", {} mW ({}), {} mJ per frame", milli(power, 1), milli_band(power),
                        milli(point.median(&LoopOutcome::frame_j), 3));
  return text;
}

/// Lower clocks that meet the limits although one between does not; empty without such.
std::string lucky_text(const Choice& choice) {
  if (choice.lucky.empty()) return {};
  std::vector<std::string> lucky;
  for (const TunePoint* lower : choice.lucky) lucky.push_back(short_text(*lower));
  return fmt::format("lower ones that meet the limits by chance: {}; {} does not",
                     fmt::join(lucky, ", "), short_text(*choice.highest_failing));
}

std::string choice_line(const Choice& choice) {
  const std::string rate = fmt::format("  {:g} frames/s: ", choice.fps);
  const std::string lucky = lucky_text(choice);
  const std::string chosen =
      choice.lowest == nullptr
          ? "none of these clocks"
          : fmt::format("{}: {}", clock_text(choice.lowest->setting), point_text(*choice.lowest));
  return fmt::format("{}{}{}{}\n", rate, chosen, lucky.empty() ? "" : "\n    ", lucky);
}

Json banded_json(const std::optional<Banded>& figure) {
  return figure ? Json(figure->value) : Json(nullptr);
}

/// A percentile of the latency, in the files and on the page, and in the table.
struct LatencyColumn {
  const char* key;
  const char* title;  ///< on the page, if it is there
  Head shown;
  std::int64_t CameraFigures::Latencies::*of;
};
const std::array kLatencies{
    LatencyColumn{"latency_p50_ns",
                  "median latency",
                  {"p50 ms", kRight, 3},
                  &CameraFigures::Latencies::p50_ns},
    LatencyColumn{"latency_p95_ns", "", {"p95 ms", kRight, 3}, &CameraFigures::Latencies::p95_ns},
    LatencyColumn{
        "latency_p99_ns", "latency of 99 %", {"p99 ms"}, &CameraFigures::Latencies::p99_ns},
    LatencyColumn{"latency_worst_ns",
                  "worst latency",
                  {"worst ms", kRight, 3},
                  &CameraFigures::Latencies::max_ns}};

/// A row of runs.csv.
struct Run {
  const TunePoint& point;
  const RunOutcome& outcome;
  const Variation& variation;
};

Columns<Run> run_columns(const TunePlan& plan) {
  using R = const Run&;
  using C = const CameraFigures&;
  const auto setup = [](const char* title, const char* key, const char* unit = "") -> Head {
    return {.title = title, .key = key, .unit = unit, .is_setup = true};
  };
  const auto camera = [](auto of) {
    return [of](R r) { return Cell(of(r.outcome.loop->camera)); };
  };
  const auto milli = [](std::optional<Banded> LoopOutcome::*figure, double Banded::*part) {
    return [=](R r) {
      const std::optional<Banded>& banded = *r.outcome.loop.*figure;
      return banded ? Cell(*banded.*part * 1e3) : Cell();
    };
  };
  Columns<Run> columns{
      {setup("frame rate", "fps", "frames/s"), [](R r) { return r.point.fps; }},
      {setup("clock", "clock_mhz", "MHz"), [](R r) { return megahertz(r.point.setting.clock); }},
      {setup("supply", "voltage", "V"),
       [](R r) {
         const auto& voltage = r.point.setting.voltage;
         return voltage ? Cell(voltage->count()) : Cell();
       }},
      {{.key = "deadline"}, [&plan](R) { return info_of(plan.deadline).name; }},
      {{.key = "seed"}, [](R r) { return r.variation.seed; }},
      {setup("variation", "variation"), [](R r) { return r.variation.name; }},
      {{.key = "arrived"}, camera([](C c) { return c.arrived; })},
      {{.key = "processed"}, camera([](C c) { return c.processed; })},
      {{.key = "dropped"}, camera([](C c) { return c.dropped; })},
      {{.key = "late"}, camera([](C c) { return c.late; })},
      {{.key = "missed"}, camera([](C c) { return c.missed(); })},
      {{.title = "missed frames", .key = "missed_share", .decimals = 6, .unit = "%", .scale = 100},
       camera([](C c) { return c.share_of(c.missed()); })},
      {{.key = "waited"}, camera([](C c) { return c.waited; })},
      {{.key = "most_found"}, camera([](C c) { return c.most_found; })}};
  for (const LatencyColumn& latency : kLatencies)
    columns.push_back({{.title = latency.title, .key = latency.key, .unit = "ms", .scale = kNsToMs},
                       camera([of = latency.of](C c) { return c.latency.*of; })});
  const auto add_milli = [&](const char* title, const char* unit, const char* key, auto figure,
                             double Banded::*part) {
    columns.push_back(
        {{.title = title, .key = key, .decimals = 9, .unit = unit}, milli(figure, part)});
  };
  add_milli("power", "mW", "power_mw", &LoopOutcome::power_w, &Banded::value);
  add_milli("", "", "power_low_mw", &LoopOutcome::power_w, &Banded::low);
  add_milli("", "", "power_high_mw", &LoopOutcome::power_w, &Banded::high);
  add_milli("energy per frame", "mJ", "frame_mj", &LoopOutcome::frame_j, &Banded::value);
  add_milli("", "", "frame_low_mj", &LoopOutcome::frame_j, &Banded::low);
  add_milli("", "", "frame_high_mj", &LoopOutcome::frame_j, &Banded::high);
  columns.insert(
      columns.end(),
      {{ate_head("position error (ATE)"), [](R r) { return r.outcome.ate_m; }},
       {{.key = "matched"}, [](R r) { return r.outcome.matched; }},
       {completion_head(), [](R r) { return r.outcome.completion; }},
       {{.key = "path_m", .decimals = 9}, [](R r) { return r.outcome.path_m; }},
       {{.title = "failure", .key = "failure"}, [](R r) { return r.outcome.failure; }},
       {{.key = "point_meets_limits"}, [&plan](R r) { return is_enough(r.point, plan); }}});
  return columns;
}

/// By point, then variation.
std::vector<Run> runs_of(const TunePlan& plan, const std::vector<TunePoint>& points) {
  std::vector<Run> runs;
  for (const TunePoint& point : points)
    for (std::size_t i = 0; i < point.outcomes.size(); ++i)
      runs.push_back({point, point.outcomes[i], plan.variations[i]});
  return runs;
}

/// The same as boxes of a page, one for each frame rate.
std::vector<StudyBox> choice_boxes(const TunePlan& plan, const std::vector<Choice>& choices) {
  std::vector<StudyBox> boxes;
  for (const Choice& choice : choices) {
    StudyBox& box = boxes.emplace_back();
    box.good = choice.lowest != nullptr;
    box.mark = fmt::format("{:g} frames/s", choice.fps);
    if (!*box.good) {
      box.sentence = fmt::format(
          "None of these clocks has at most {:g} % missed and {:g} m of ATE in 95 % of the runs.",
          100 * plan.miss_rate, plan.ate_m);
      continue;
    }
    box.sentence = fmt::format(
        "{}: the lowest of these clocks with at most {:g} % missed and {:g} m of ATE in 95 % of "
        "the runs.",
        clock_text(choice.lowest->setting), 100 * plan.miss_rate, plan.ate_m);
    box.lines.push_back(point_text(*choice.lowest));
    if (std::string lucky = lucky_text(choice); !lucky.empty())
      box.lines.push_back(std::move(lucky));
    if (choice.lowest == chosen(choices))
      box.lines.push_back("The lowest of all: " + run_command_text(plan, *choice.lowest));
  }
  return boxes;
}

}  // namespace

std::string tune_notes(const TunePlan& plan) {
  std::string text = fmt::format(
      "missed: dropped, or later than a period; {}; mean power over all of the time; ATE: "
      "{}-aligned RMSE of the processed frames\n",
      info_of(plan.deadline).description, name_of(plan.measure.alignment));
  if (plan.variations.size() > 1)
    text += fmt::format("medians over {}; failed: above the limit, or diverged; poses: the least\n",
                        plan.perturbs ? fmt::format("{} perturbed runs (runs.csv names them), "
                                                    "{} of clocks that are recommended",
                                                    plan.screening, plan.variations.size())
                                      : fmt::format("{} seeds", plan.variations.size()));
  return text;
}

Json choice_json(const TunePlan& plan, const std::vector<Choice>& choices) {
  Json document;
  document["lowest"] = Json::array();
  for (const Choice& choice : choices) {
    Json& entry = document["lowest"].emplace_back(Json::object());
    entry["fps"] = choice.fps;
    entry["clock_mhz"] = choice.lowest ? Json(megahertz(choice.lowest->setting.clock)) : Json();
    if (choice.lowest != nullptr)
      entry["power_w"] = banded_json(choice.lowest->median(&LoopOutcome::power_w));
  }
  const TunePoint* best = chosen(choices);
  document["chosen"] = best != nullptr ? Json(run_command_text(plan, *best)) : Json();
  return document;
}

StudyPage tune_page(const TunePlan& plan, const std::vector<TunePoint>& points,
                    const std::vector<Choice>& choices) {
  StudyPage page;
  page.title = fmt::format("Clocks for {} on {}", plan.request.profile, plan.options.platform);
  page.boxes = choice_boxes(plan, choices);
  page.summary = tune_notes(plan);
  page.points = tune_rows(plan, points);
  page.curves = {"clock_mhz", "fps", {"missed_share", "ate_rmse_m", "power_mw", "latency_p99_ns"}};
  page.limits = {{"missed_share", 100 * plan.miss_rate}, {"ate_rmse_m", plan.ate_m}};
  page.x = "power_mw";
  page.y = "ate_rmse_m";
  page.colour = "fps";
  return page;
}

std::string tune_table(const TunePlan& plan, const std::vector<TunePoint>& points) {
  using P = const TunePoint&;
  Columns<TunePoint> table{
      {{"frames/s"}, [](P p) { return fmt::format("{:g}", p.fps); }},
      {{"MHz"}, [](P p) { return fmt::format("{:g}", megahertz(p.setting.clock)); }},
      {{"V", kRight, 1}, [](P p) { return volts(p.setting); }},
      {{"missed %"}, [](P p) { return percent(p.miss_rate()); }},
      {{"dropped %", kRight, 3}, [](P p) { return percent(p.drop_rate()); }}};
  for (const LatencyColumn& latency : kLatencies)
    table.push_back(
        {latency.shown, [of = latency.of](P p) {
           return ms(p.median([of](const LoopOutcome& l) { return double(l.camera.latency.*of); }));
         }});
  table.push_back({{"mW"}, [](P p) { return milli(p.median(&LoopOutcome::power_w), 2); }});
  table.push_back(
      {{"band", kRight, 2}, [](P p) { return milli_band(p.median(&LoopOutcome::power_w)); }});
  table.push_back(
      {{"mJ/frame", kRight, 2}, [](P p) { return milli(p.median(&LoopOutcome::frame_j), 3); }});
  table.push_back({{"ATE m"}, [](P p) { return error_text(p.ate().median, 3); }});
  if (plan.variations.size() > 1)
    table.push_back({{"least … greatest"}, [](P p) {
                       return fmt::format("{} … {}", error_text(p.ate().low, 3),
                                          error_text(p.ate().high, 3));
                     }});
  if (plan.perturbs)
    table.push_back({{"failed", kRight, 1}, [&](P p) {
                       return fmt::format("{} of {}", p.failures(plan.ate_m), p.outcomes.size());
                     }});
  table.push_back({{"poses %", kRight, 2}, [](P p) { return percent(p.completion()); }});
  table.push_back({{"meets limits", kLeft}, [&](P p) { return is_enough(p, plan) ? "yes" : ""; }});
  std::vector<TunePoint> sorted = points;
  std::stable_partition(sorted.begin(), sorted.end(), [&](P p) { return is_enough(p, plan); });
  return terminal_text(table_of(table, sorted));
}

Table tune_rows(const TunePlan& plan, const std::vector<TunePoint>& points) {
  return table_of(run_columns(plan), runs_of(plan, points));
}

std::string choice_text(const TunePlan& plan, const std::vector<Choice>& choices) {
  if (choices.size() == 1 && choices.front().lowest != nullptr) {
    const std::string lucky = lucky_text(choices.front());  // the rest is the conclusion
    return lucky.empty() ? lucky : lucky + '\n';
  }
  std::string text = fmt::format(
      "the lowest clocks from which on all have at most {:g} % missed and an ATE of {:g} "
      "m in 95 % of the runs:\n",
      100 * plan.miss_rate, plan.ate_m);
  for (const Choice& choice : choices) text += choice_line(choice);
  return text;
}

std::string claim_text(const TunePlan& plan, const TunePoint& best) {
  if (!plan.perturbs) return {};
  const std::size_t runs = best.outcomes.size(), failures = best.failures(plan.ate_m);
  return fmt::format(
      "it held in {} of {} perturbed runs: of other starts {:.0f} % or more do, with 95 % "
      "confidence\n",
      runs - failures, runs, std::floor(100 * share_held(runs, failures)));
}

std::string tune_conclusion(const std::vector<Choice>& choices) {
  const TunePoint* best = chosen(choices);
  if (best == nullptr) return "verdict: NOT met: no point meets the limits";
  return fmt::format("verdict: met: the lowest of all: {} at {:g} frames/s: {}",
                     clock_text(best->setting), best->fps, point_text(*best));
}

}  // namespace leviosim::tools
