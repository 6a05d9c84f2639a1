#include "tools/app/why/late_frame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

#include "sim/base/check.h"
#include "sim/chip/chip.h"
#include "sim/chip/timing.h"
#include "sim/events/timebase.h"
#include "sim/soc/run_account.h"
#include "sim/work/program.h"
#include "tools/app/cli/screen.h"
#include "tools/app/result/summary.h"
#include "workload/vio/frame_facts.h"

namespace leviosim::tools {
namespace {

/// In a sentence: so many stages, whose times differ by so much.
constexpr std::size_t kNamedStages = 2;
constexpr double kLeastNamed_ms = 0.05;

double to_ms(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

std::int64_t own_ns(const FrameResult& frame) { return frame.end_ns - frame.start_ns; }
std::int64_t latency_ns(const FrameResult& frame) { return frame.end_ns - frame.arrival_ns; }

/// Of the work of one frame.
TimedParts parts_of(const work::Job& job, const sim::JobTiming& timing, const sim::ChipConfig& chip,
                    int cores) {
  soc::RunAccount account({}, chip);
  account.add_work(job);
  account.add_parallel(timing);
  RunResult one;
  one.cores = cores;
  one.stages = account.stages();
  return {cycle_parts(one), cores, 1, chip.cluster.clock};
}

/// The same with one stage alone.
TimedParts only(const TimedParts& parts, std::string_view stage) {
  TimedParts result{{}, parts.cores, parts.frames, parts.clock};
  for (const StageParts& s : parts.stages)
    if (s.stage == stage) result.stages.push_back(s);
  return result;
}

double ms_of(const ExplainedFrame& frame, std::string_view stage) {
  double ms = 0;
  for (const StageSpan& span : frame.stages)
    if (span.stage == stage) ms += span.ms();
  return ms;
}

/// The stages of both, in the order in which they run.
std::vector<std::string_view> stages_of(const ExplainedFrame& a, const ExplainedFrame& b) {
  std::vector<std::string_view> names;
  for (const ExplainedFrame* frame : {&a, &b})
    for (const StageSpan& span : frame->stages)
      if (std::find(names.begin(), names.end(), span.stage) == names.end())
        names.push_back(span.stage);
  return names;
}

/// The first letter of each stage's name that no stage before it has.
std::vector<char> letters_of(const std::vector<std::string_view>& stages) {
  std::vector<char> letters;
  for (const std::string_view stage : stages) {
    char letter = '#';
    for (const char c : stage) {
      const auto upper = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      if (std::isalnum(static_cast<unsigned char>(c)) == 0) continue;
      if (std::find(letters.begin(), letters.end(), upper) != letters.end()) continue;
      letter = upper;
      break;
    }
    letters.push_back(letter);
  }
  return letters;
}

/// The middle of a column decides what is seen in it.
std::string bar(const ExplainedFrame& frame, const std::vector<std::string_view>& stages,
                const std::vector<char>& letters, double column_ms, std::size_t columns) {
  std::string text(columns, ' ');
  for (std::size_t i = 0; i < columns; ++i) {
    const double at = (static_cast<double>(i) + 0.5) * column_ms;
    if (at < frame.waited_ms) text[i] = '.';
    for (const StageSpan& span : frame.stages) {
      if (at < span.begin_ms || at >= span.end_ms) continue;
      const auto stage = std::find(stages.begin(), stages.end(), span.stage) - stages.begin();
      text[i] = letters[static_cast<std::size_t>(stage)];
    }
  }
  return text;
}

std::string punctuality(const ExplainedFrame& frame, double period_ms) {
  const double late_ms = frame.latency_ms() - period_ms;
  std::string text = late_ms > 0 ? fmt::format("frame {} was {:.2f} ms late", frame.number, late_ms)
                                 : fmt::format("frame {} was in time", frame.number);
  text += fmt::format(": its own work took {:.2f} ms of {:.4g}", frame.own_ms, period_ms);
  if (frame.waited_ms > 0)
    text += fmt::format(", after {:.2f} ms of waiting for the frame before", frame.waited_ms);
  return text;
}

}  // namespace

int median_frame(const std::vector<FrameResult>& frames) {
  check(!frames.empty(), "a median is of frames");
  std::vector<int> order(frames.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return own_ns(frames[static_cast<std::size_t>(a)]) <
           own_ns(frames[static_cast<std::size_t>(b)]);
  });
  return order[(order.size() - 1) / 2];
}

int slowest_frame(const std::vector<FrameResult>& frames) {
  const auto slowest = std::max_element(
      frames.begin(), frames.end(),
      [](const FrameResult& a, const FrameResult& b) { return latency_ns(a) < latency_ns(b); });
  check(slowest != frames.end(), "the slowest is one of the frames");
  return static_cast<int>(slowest - frames.begin());
}

FrameWatcher::FrameWatcher(const sim::ChipConfig& chip, int cores, int frame, int other)
    : chip_(chip), cores_(cores) {
  frames_[0].number = frame;
  frames_[1].number = other;
}

void FrameWatcher::on_front_end(const FrontEndJob& job) {
  for (ExplainedFrame& frame : frames_) {
    if (frame.number != job.frame) continue;
    const sim::Timebase timebase = sim::timebase_of(chip_);
    frame.result = job.result;
    frame.waited_ms = to_ms(job.result.start_ns - job.result.arrival_ns);
    frame.own_ms = to_ms(own_ns(job.result));
    const auto since_arrival = [&](sim::Time time) {
      return to_ms(timebase.whole_nanoseconds(time - sim::Time()) - job.result.arrival_ns);
    };
    for (const sim::StageTiming& stage : job.parallel.stages)
      frame.stages.push_back({stage.stage, since_arrival(stage.begin), since_arrival(stage.end)});
    frame.parts = parts_of(job.job, job.parallel, chip_, cores_);
  }
}

std::vector<StageDifference> stage_differences(const ExplainedFrame& median,
                                               const ExplainedFrame& frame) {
  std::vector<StageDifference> differences;
  for (const std::string_view stage : stages_of(median, frame)) {
    StageDifference& difference = differences.emplace_back(
        StageDifference{std::string(stage), ms_of(median, stage), ms_of(frame, stage), {}, 0});
    const std::vector<MainCause> causes =
        main_causes(only(median.parts, stage), only(frame.parts, stage));
    if (causes.empty()) continue;
    difference.cause = causes.front().what;
    difference.cause_ms = causes.front().ms;
  }
  return differences;
}

std::vector<FactDifference> fact_differences(const ExplainedFrame& median,
                                             const ExplainedFrame& frame) {
  constexpr double kNoticed = 0.1;
  std::vector<std::pair<double, FactDifference>> found;
  const auto add = [&](std::string_view fact, double weight, std::string a, std::string b) {
    if (weight >= kNoticed)
      found.push_back({weight, {std::string(fact), std::move(a), std::move(b)}});
  };
  if (median.result.source != frame.result.source) {
    const auto words = [](const FrameResult& f) {
      return std::string(vio::kPoseSources[static_cast<std::size_t>(f.source)].words);
    };
    add("source of the pose", 2, words(median.result), words(frame.result));
  }
  if (median.result.keyframe != frame.result.keyframe)
    add("keyframe", 1, median.result.keyframe ? "yes" : "no", frame.result.keyframe ? "yes" : "no");
  for (const vio::FrameFact& fact : vio::kFrameFacts) {
    if (!fact.adds_up) continue;
    const double a = median.result.*fact.of;
    const double b = frame.result.*fact.of;
    add(fact.meaning, std::abs(b - a) / std::max({a, b, 1.0}), fmt::format("{}", a),
        fmt::format("{}", b));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& x, const auto& y) { return x.first > y.first; });
  std::vector<FactDifference> differences;
  for (auto& [weight, difference] : found) differences.push_back(std::move(difference));
  return differences;
}

std::string why_text(const ExplainedFrame& median, const ExplainedFrame& frame, double period_ms) {
  std::string text = punctuality(frame, period_ms);
  if (median.number == frame.number) return text + "; it is the median frame";
  text += fmt::format(", {:+.2f} ms beside the median frame {}", frame.own_ms - median.own_ms,
                      median.number);
  std::vector<StageDifference> stages = stage_differences(median, frame);
  std::stable_sort(stages.begin(), stages.end(), [](const auto& a, const auto& b) {
    return std::abs(a.change_ms()) > std::abs(b.change_ms());
  });
  std::vector<std::string> most;
  for (const StageDifference& stage : stages) {
    if (most.size() == kNamedStages || std::abs(stage.change_ms()) < kLeastNamed_ms) break;
    most.push_back(fmt::format("{} {:+.2f} ms ({})", stage.stage, stage.change_ms(), stage.cause));
  }
  if (most.empty()) return text;
  return fmt::format("{}: {}", text, fmt::join(most, ", "));
}

std::string frame_bars(const ExplainedFrame& median, const ExplainedFrame& frame, double period_ms,
                       int width) {
  const std::vector<std::string_view> stages = stages_of(median, frame);
  const std::vector<char> letters = letters_of(stages);
  const std::string head = fmt::format(
      "{:<{}}", "", fmt::format("frame {} ", std::max(median.number, frame.number)).size());
  const auto columns =
      static_cast<std::size_t>(std::max(10, width - static_cast<int>(head.size())));
  const double whole_ms = std::max({median.latency_ms(), frame.latency_ms(), period_ms});
  const double column_ms = whole_ms / static_cast<double>(columns);
  std::string text;
  for (const ExplainedFrame* f : {&median, &frame})
    text += fmt::format("{:<{}}{}\n", fmt::format("frame {}", f->number), head.size(),
                        bar(*f, stages, letters, column_ms, columns));
  const auto deadline =
      std::min(columns - 1,
               static_cast<std::size_t>(period_ms / whole_ms * static_cast<double>(columns - 1)));
  const std::string mark = fmt::format("{:.4g} ms ", period_ms);
  const std::size_t before = head.size() + deadline;
  text += fmt::format("{:>{}}^\n", before >= mark.size() ? "deadline " + mark : "", before);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < stages.size(); ++i)
    names.push_back(fmt::format("{} {}", letters[i], stages[i]));
  if (frame.waited_ms > 0 || median.waited_ms > 0) names.push_back(". waits");
  return text + wrap(names, ", ", 2, width) + "\n";
}

}  // namespace leviosim::tools
