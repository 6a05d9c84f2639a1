#include "tools/app/result/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/app/result/summary.h"
#include "tools/app/table/cell.h"

namespace leviosim::tools {
namespace {

std::string ms(double ns) { return fmt::format("{:.4g} ms", ns * 1e-6); }

/// Of two digits: 0.026, 9.6, 54.
std::string short_ms(double ns) {
  if (ns < 1e6) return fmt::format("{:.2g}", ns * 1e-6);
  return fmt::format("{:.{}f}", ns * 1e-6, ns < 10e6 ? 1 : 0);
}

/// A time of the run, "54.5 (48–62) ms" where its band is known.
struct TimeFigure {
  double ns = 0;
  std::optional<Banded> band{};

  std::string text() const {
    if (!band) return ms(ns);
    return fmt::format("{:.4g} ({}–{}) ms", ns * 1e-6, short_ms(band->low), short_ms(band->high));
  }
};

/// Absent if nothing was timed.
std::optional<TimeFigure> time_figure(const RunFigures& run, const std::string& name) {
  const auto value = run.value(name);
  if (!value) return std::nullopt;
  const auto low = run.value(name + ".low");
  const auto high = run.value(name + ".high");
  if (!low || !high) return TimeFigure{*value};
  return TimeFigure{*value, Banded{*value, *low, *high}};
}

/// What the band leaves open: whether it is the mean or the slowest frame that fits.
std::string undecided(const TimeFigure& figure, double deadline) {
  if (!figure.band || !figure.band->holds(deadline)) return {};
  return fmt::format(": the band includes {:.4g}", deadline * 1e-6);
}

/// Frames by what became of them: "3 of 400 frames late".
std::string missed_text(const RunFigures& run, double arrived, double missed) {
  const double dropped = run.value("camera.dropped").value_or(0);
  return fmt::format("{:.0f} of {:.0f} frames {}", missed, arrived,
                     dropped == 0        ? "late"
                     : dropped == missed ? "dropped"
                                         : fmt::format("late or dropped ({:.0f})", dropped));
}

/// By the frames' own times; where a camera runs, by what comes out of waiting for it, too. Absent
/// where nothing was timed.
std::optional<RunVerdict> time_verdict(const RunFigures& run) {
  const auto mean = time_figure(run, "frame.time.mean");
  const auto rate = run.value("frame.sustainable_rate");
  const bool queues = run.value("camera.arrived").has_value();
  const auto own_worst = time_figure(run, "frame.time.worst");
  const auto latency_worst = run.value("frame.latency.worst");
  const auto missed_share = run.value("frame.missed_share");
  if (!missed_share) return std::nullopt;
  const double arrived =
      run.value("camera.arrived").value_or(run.value("frames.count").value_or(0));
  const double deadline = deadline_ns(run);
  if (!mean || !rate || !own_worst || !latency_worst)
    return RunVerdict{"time", Grade::bad, {fmt::format("all {:.0f} frames were dropped", arrived)}};
  const double missed = std::round(*missed_share * arrived);
  const std::string mean_text =
      fmt::format("a frame takes {} on average of {}", mean->text(), ms(deadline));
  if (mean->ns > deadline) {
    RunVerdict verdict{"time", Grade::bad, {mean_text + undecided(*mean, deadline)}};
    verdict.reasons.push_back(fmt::format("which sustains {:.3g} frames/s", *rate));
    if (queues) verdict.reasons.push_back(missed_text(run, arrived, missed));
    return verdict;
  }
  const std::string worst_text =
      fmt::format("worst {}{}", own_worst->text(), undecided(*own_worst, deadline));
  RunVerdict verdict{"time", missed > 0 ? Grade::doubtful : Grade::good, {}};
  if (missed > 0)
    verdict.reasons = {missed_text(run, arrived, missed), mean_text};
  else
    verdict.reasons = {fmt::format("all {:.0f} frames within {}", arrived, ms(deadline))};
  verdict.reasons.push_back(worst_text);
  if (queues && *latency_worst > own_worst->ns)
    verdict.reasons.push_back(fmt::format("with waiting {}", ms(*latency_worst)));
  return verdict;
}

/// Absent where nothing is known of memories.
std::optional<RunVerdict> memory_verdict(const RunFigures& run) {
  std::optional<RunVerdict> verdict;
  for (const auto& [name, key] : {std::pair{"L1", "l1"}, {"L2", "l2"}}) {
    const auto used = run.value(fmt::format("memory.{}.peak", key));
    const auto size = run.value(fmt::format("run.{}_size", key));
    if (!used || !size || *size <= 0) continue;
    if (!verdict) verdict = RunVerdict{"memory", Grade::good, {}};
    if (*used > *size) verdict->grade = Grade::bad;
    verdict->reasons.push_back(fmt::format(
        "{} {}", name, of_memory(Bytes(std::llround(*used)), Bytes(std::llround(*size)))));
  }
  return verdict;
}

/// "0.03 m of path, uncertain by 0.01 m".
std::string path_text(const MapSigns& signs) {
  return fmt::format("{} m of path, uncertain by {} m", readable(*signs.own_path_m, 2),
                     readable(*signs.path_deviation_m, 2));
}

std::string text_of(vio::HealthReason reason, const MapSigns& signs) {
  if (reason == vio::HealthReason::Drift && signs.own_path_m) return path_text(signs);
  return std::string(vio::kHealthReasons[static_cast<std::size_t>(reason)]);
}

/// Why the estimator ends with a map that is not good.
std::vector<std::string> reasons_of(vio::Health health, const MapSigns& signs) {
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < vio::kHealthReasons.size(); ++i)
    if ((signs.health_reasons >> i & 1) != 0)
      reasons.push_back(fmt::format("{} (since frame {})",
                                    text_of(static_cast<vio::HealthReason>(i), signs),
                                    signs.reason_since[i]));
  if (reasons.empty())  // replays of traces that do not have them
    reasons.push_back(fmt::format("the estimator ends with a map that is {}",
                                  vio::kHealthNames[static_cast<std::size_t>(health)]));
  return reasons;
}

/// "frames 20 to 44", or "12 of frames 20 to 44".
std::string frames_text(const FrameSpan& span) {
  const bool all = span.frames == span.last - span.first + 1;
  if (span.frames == 1) return fmt::format("frame {}", span.first);
  return fmt::format("{}frames {} to {}", all ? "" : fmt::format("{} of ", span.frames), span.first,
                     span.last);
}

/// What the estimator doubted for a while; guesses are named apart.
void add_past_reasons(const MapSigns& signs, std::vector<std::string>& reasons) {
  for (std::size_t i = 0; i < signs.past_reasons.size(); ++i)
    if (signs.past_reasons[i] && static_cast<vio::HealthReason>(i) != vio::HealthReason::NoScale)
      reasons.push_back(
          fmt::format("{} ({})", vio::kHealthReasons[i], frames_text(*signs.past_reasons[i])));
}

/// How far a scale is off, in either direction.
double off(double scale) { return scale > 0 ? std::max(scale, 1 / scale) : INFINITY; }

}  // namespace

std::string_view name_of(Grade grade) {
  static constexpr std::array<std::string_view, 4> kNames{"good", "unknown", "doubtful", "bad"};
  return kNames[static_cast<std::size_t>(grade)];
}

double severity(Grade grade) {
  static constexpr std::array kSeverities{0.0, 0.5, 1.0, 2.0};
  return kSeverities[static_cast<std::size_t>(grade)];
}

const std::vector<VerdictWord>& verdict_words() {
  static const std::vector<VerdictWord> words{{"time", "fits", Grade::good},
                                              {"time", "fits on average", Grade::doubtful},
                                              {"time", "too slow", Grade::bad},
                                              {"memory", "fits", Grade::good},
                                              {"memory", "does not fit", Grade::bad},
                                              {"map", "good", Grade::good},
                                              {"map", "not judged", Grade::unknown},
                                              {"map", "unreliable", Grade::doubtful},
                                              {"map", "lost", Grade::bad}};
  return words;
}

std::string_view RunVerdict::word() const {
  for (const VerdictWord& w : verdict_words())
    if (w.about == about && w.grade == grade) return w.word;
  return {};
}

std::string RunVerdict::reason() const { return fmt::format("{}", fmt::join(reasons, ", ")); }

std::string RunVerdict::text() const {
  std::string text = fmt::format("{} {}", about, word());
  const bool says_why = grade != Grade::good || about != "memory";
  return says_why && !reasons.empty() ? text + ": " + reason() : text;
}

Grade Verdicts::grade() const {
  Grade worst = Grade::good;
  for (const RunVerdict& verdict : list) worst = std::max(worst, verdict.grade);
  return worst;
}

std::string Verdicts::text() const {
  if (list.empty()) return "no frames";
  std::vector<RunVerdict> sorted = list;
  std::stable_sort(sorted.begin(), sorted.end(), [](const RunVerdict& a, const RunVerdict& b) {
    return a.grade > std::max(b.grade, Grade::unknown);  // what is not judged is no fault
  });
  std::vector<std::string> texts;
  for (const RunVerdict& verdict : sorted) texts.push_back(verdict.text());
  if (sorted.front().about == "time") texts.front().erase(0, std::string_view("time ").size());
  return fmt::format("{}", fmt::join(texts, ", "));
}

namespace {

using Fault = std::function<void(bool is_lost, std::string reason)>;

/// Of the poses that are no guesses. On a short path the error counts as on one of kShortestPath_m.
void judge_by_truth(const TruthSigns& truth, const MapLimits& limits, const Fault& fault) {
  if (!truth.error_m || !truth.path_m) return;
  const bool is_short = *truth.path_m < kShortestPath_m;
  const double path_m = std::max(*truth.path_m, kShortestPath_m);
  const double error_m = truth.located_m.value_or(*truth.error_m);
  const double share = error_m / path_m;
  if (!(error_m < kDiverged_m)) return fault(true, "the path diverged");
  if (share > limits.error_share)
    fault(share > limits.lost_error_share,
          is_short ? fmt::format("the error is {} m on a path of {} m", readable(error_m, 2),
                                 readable(*truth.path_m, 2))
                   : fmt::format("the error is {} % of the path", readable(100 * share, 1)));
  if (truth.tilt_deg && !(*truth.tilt_deg < limits.tilt_deg))
    fault(false, fmt::format("the vertical is off by {}°", readable(*truth.tilt_deg, 1)));
  if (!is_short && truth.scale && !(off(*truth.scale) < limits.scale))
    fault(!(off(*truth.scale) < limits.lost_scale),
          fmt::format("the scale is {}", readable(*truth.scale, 2)));
}

/// Which poses the verdict does not judge.
std::string guesses_text(const MapSigns& signs) {
  const std::string poses = signs.guesses == 1 ? "a pose" : fmt::format("{} poses", signs.guesses);
  const char* const are = signs.guesses == 1 ? "is a guess" : "are guesses";
  if (!signs.located_from) return fmt::format("{} {}", poses, are);
  return fmt::format("from frame {} on; {} before {}", *signs.located_from, poses, are);
}

/// Whether the path is so short that a share of it says nothing, and no reason has named it.
bool is_uncertain(const MapSigns& signs, const MapLimits& limits) {
  return signs.own_path_m && (signs.health_reasons & bit(vio::HealthReason::Drift)) == 0 &&
         *signs.path_deviation_m > limits.error_share * *signs.own_path_m;
}

}  // namespace

RunVerdict map_verdict(const MapSigns& signs, const MapLimits& limits) {
  RunVerdict verdict{"map", Grade::good, {}};
  const auto fault = [&](bool is_lost, std::string reason) {
    verdict.grade = std::max(verdict.grade, is_lost ? Grade::bad : Grade::doubtful);
    verdict.reasons.push_back(std::move(reason));
  };
  judge_by_truth(signs.truth, limits, fault);
  if (signs.kept_s > limits.kept_s)
    fault(signs.ends_without_pose, fmt::format("the pose was kept for {:.1f} s", signs.kept_s));
  if (signs.initialising_s > limits.initialising_s)
    fault(signs.ends_without_pose,
          fmt::format("the initialisation took {:.1f} s", signs.initialising_s));
  if (signs.restarts > 2 &&
      static_cast<double>(signs.restarts) > limits.restarts_per_s * signs.duration_s)
    fault(false, fmt::format("the map was restarted {} times", signs.restarts));
  const auto health =
      static_cast<vio::Health>(signs.health.value_or(static_cast<int>(vio::Health::not_judged)));
  if (health == vio::Health::unreliable || health == vio::Health::lost)
    for (std::string& reason : reasons_of(health, signs))
      fault(health == vio::Health::lost, std::move(reason));
  else if (signs.lost.frames > 0)
    fault(false, fmt::format("the estimator had lost its map in {} frames, from {} to {}",
                             signs.lost.frames, signs.lost.first, signs.lost.last));
  if (signs.poses_left_out > 0) fault(true, fmt::format("{} poses are NaN", signs.poses_left_out));
  if (signs.guesses > 0) verdict.reasons.push_back(guesses_text(signs));
  if (is_uncertain(signs, limits)) verdict.reasons.push_back(path_text(signs));
  add_past_reasons(signs, verdict.reasons);
  if (signs.at_rest_since)
    verdict.reasons.push_back(fmt::format("at rest since frame {}", *signs.at_rest_since));
  if (verdict.grade > Grade::unknown && signs.features && *signs.features < limits.features)
    verdict.reasons.push_back(
        fmt::format("images have {} features on average", readable(*signs.features, 1)));
  const bool says_little = !signs.truth.error_m || signs.truth.path_m < kShortestPath_m;
  if (verdict.grade == Grade::good && says_little && health == vio::Health::not_judged) {
    verdict.grade = Grade::unknown;
    verdict.reasons.push_back(
        "there is no truth of 1 m or more, and the profile does not watch its map");
  }
  return verdict;
}

Verdicts verdicts_of(const RunFigures& run) {
  Verdicts all;
  if (run.value("frames.count").value_or(0) == 0 && !run.value("camera.arrived")) return all;
  if (std::optional<RunVerdict> time = time_verdict(run)) all.list.push_back(std::move(*time));
  if (std::optional<RunVerdict> memory = memory_verdict(run))
    all.list.push_back(std::move(*memory));
  if (!run.map.has_poses) return all;
  RunVerdict& map = all.list.emplace_back(map_verdict(run.map));
  const double arrived = run.value("camera.arrived").value_or(0);
  const double dropped = run.value("camera.dropped").value_or(0);
  if (dropped > 0 && map.grade != Grade::unknown)
    map.reasons.push_back(fmt::format("of the {:.0f} of {:.0f} frames that were processed",
                                      arrived - dropped, arrived));
  return all;
}

std::int64_t map_restarts(const RunResult& run) {
  std::int64_t restarts = 0;
  for (const FrameResult& frame : run.frames) restarts += frame.map_restarts;
  return restarts;
}

}  // namespace leviosim::tools
