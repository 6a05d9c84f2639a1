#include "tools/app/timeline/timeline_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/printable.h"
#include "sim/base/text.h"
#include "sim/chip/accelerator.h"
#include "tools/app/cli/screen.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/timeline/core_slices.h"
#include "tools/app/timeline/waits.h"

namespace leviosim::tools {
namespace {

/// Pixels, x right, y down.
struct SvgPoint {
  double x = 0;
  double y = 0;
};

struct SvgBox {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

struct TextStyle {
  double size = 12;              ///< [px]
  const char* anchor = "start";  ///< or middle, end
  const char* colour = "#333333";
  bool bold = false;
};

/// Two decimals, no negative zero.
std::string px(double value) {
  constexpr double kPrintsAsZero = 0.005;
  return fmt::format("{:.2f}", std::abs(value) < kPrintsAsZero ? 0.0 : value);
}

std::string markup(std::string_view text) { return escape_markup(printable(text)); }

/// A small writer of SVG 1.1: shapes and text in the order in which they are added.
class Svg {
 public:
  /// On white. `title` is for readers that do not see the picture.
  Svg(double width, double height, std::string_view title) : width_(width), height_(height) {
    add("<title>{}</title>\n", markup(title));
    rectangle({0, 0, width, height}, "#ffffff");
  }

  /// @param attributes  of the stroke, besides its colour and width
  void line(SvgPoint from, SvgPoint to, const char* colour, double width,
            const char* attributes = "") {
    add("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n",
        px(from.x), px(from.y), px(to.x), px(to.y), colour, px(width), attributes);
  }
  void rectangle(const SvgBox& box, std::string_view fill) {
    add("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", px(box.x), px(box.y),
        px(box.width), px(box.height), fill);
  }
  /// Many of a colour, in a third of the bytes that rectangle() takes.
  void rectangles(const std::vector<SvgBox>& boxes, std::string_view fill) {
    if (boxes.empty()) return;
    add("<path fill=\"{}\" d=\"", fill);
    for (const SvgBox& box : boxes)
      add("M{:g} {:g}h{:g}v{:g}h{:g}z", box.x, box.y, box.width, box.height, -box.width);
    body_ += "\"/>\n";
  }
  void text(SvgPoint at, std::string_view text, const TextStyle& style) {
    add("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>\n",
        px(at.x), px(at.y), px(style.size), style.anchor, style.colour,
        style.bold ? " font-weight=\"bold\"" : "", markup(text));
  }
  /// The whole file.
  std::string str() const {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, sans-serif\">\n{2}</svg>\n",
        px(width_), px(height_), body_);
  }

 private:
  template <class... Values>
  void add(fmt::format_string<const Values&...> text, const Values&... values) {
    fmt::format_to(std::back_inserter(body_), text, values...);
  }

  std::string body_;
  double width_;
  double height_;
};

/// Between the ticks of an axis from 0: the least of 1, 2 or 5 times a power of ten that gives at
/// most `most` ticks, both ends included.
double tick_step(double length, int most) {
  constexpr std::array<double, 3> kMantissas{1, 2, 5};
  int exponent = static_cast<int>(std::floor(std::log10(length / most)));
  for (std::size_t i = 0;; ++i) {
    if (i == kMantissas.size()) {
      i = 0;
      ++exponent;
    }
    const double step = kMantissas[i] * std::pow(10.0, exponent);
    if (std::floor(length / step) + 1 <= most) return step;
  }
}

constexpr double kWidth = 1000;
constexpr double kLeftEdge = 96;
constexpr double kPlotWidth = 880;
constexpr double kLegendTop = 38;
constexpr double kLegendStep = 18;
constexpr double kRowHeight = 19;
constexpr double kRowStep = 25;
constexpr double kColumn = 2;  ///< of a strip, whose shares are shown [px]
constexpr std::size_t kColumns = 440;
constexpr double kStep = 0.25;      ///< of heights in a strip [px]
constexpr double kLetterWidth = 6;  ///< of labels, roughly [px]
constexpr const char* kInk = "#1c2733";
constexpr const char* kMiss = "#be202e";

/// What the time of a core goes to: work, the waits in their order, idle.
constexpr std::size_t kParts = 1 + kWaits.size() + 1;
constexpr std::size_t kIdle = kParts - 1;
constexpr std::array<const char*, kParts> kPartColours{"#2a7f62", "#d98e04", "#be202e", "#7a3b9a",
                                                       "#203e8c", "#5c6670", "#d5dbe1"};
/// Of stages in the order in which they come first, pale ones since names stand in them.
constexpr std::array kStageColours{"#c9d8f0", "#f3e2c7", "#e9d3e6", "#e3ecd4",
                                   "#f6cfc6", "#cfe9ea", "#f4efb8", "#d9d2ea",
                                   "#dfe3e8", "#c8e3c9", "#ead9c9", "#f7d9e3"};
constexpr std::array kIterationColours{"#dfe3e8", "#c9d1da"};

std::string_view name_of_part(std::size_t part) {
  if (part == 0) return "work";
  return part == kIdle ? "waiting for the slowest core" : kWaits[part - 1].name;
}

using Shares = std::array<double, kParts>;  ///< of a column's time

/// The time of one core, column by column.
using Strip = std::array<Shares, kColumns>;

class Picture {
 public:
  Picture(const TimelineEvents& events, const RunResult& run);

  std::string draw();

 private:
  double ms(sim::Time time) const {
    return static_cast<double>(nanoseconds(events_.timebase, time)) * 1e-6;
  }
  double x_of(double at_ms) const {
    return kLeftEdge + (at_ms - begin_ms_) / (end_ms_ - begin_ms_) * kPlotWidth;
  }
  double top() const { return kLegendTop + kLegendStep * static_cast<double>(legend_lines_) + 10; }
  double row_top(std::size_t row) const { return top() + kRowStep * static_cast<double>(row); }
  std::size_t rows() const {
    return static_cast<std::size_t>(events_.cores) + (has_external_ ? 6 : 5);
  }
  double bottom() const { return row_top(rows()); }

  void find_span();
  void add_time(Strip& strip, double from_ms, double to_ms, const Shares& shares) const;
  void add_core(std::vector<Strip>& strips, const StepEvents& step, const CoreEvents& core) const;
  std::vector<Strip> strips() const;

  const char* colour_of(std::string_view stage) const;
  void lay_out_legend();
  void draw_legend(Svg& svg) const;
  void draw_axis(Svg& svg) const;
  void draw_label(Svg& svg, std::size_t row, std::string_view name) const;
  void draw_block(Svg& svg, std::size_t row, double from_ms, double to_ms, std::string_view name,
                  std::string_view colour) const;
  void draw_front_end(Svg& svg) const;
  void draw_deadlines(Svg& svg) const;
  void draw_strip(Svg& svg, std::size_t row, const Strip& strip) const;
  void draw_cores(Svg& svg) const;
  void draw_transfers(Svg& svg, const StageEvents& stage, std::size_t row) const;
  void draw_transfers(Svg& svg) const;
  void draw_controller(Svg& svg) const;

  const TimelineEvents& events_;
  const RunResult& run_;
  double begin_ms_ = 0;
  double end_ms_ = 1;

  struct LegendItem {
    SvgPoint at;
    std::string name;
    const char* colour;
  };
  std::vector<LegendItem> legend_;
  std::size_t legend_lines_ = 0;
  bool has_external_ = false;             ///< whether data of external memory pass
  std::vector<std::string_view> stages_;  ///< in the order of their colours
};

Picture::Picture(const TimelineEvents& events, const RunResult& run) : events_(events), run_(run) {
  find_span();
  for (const FrameEvents& frame : events_.frames)
    for (const StageEvents& stage : frame.stages)
      if (std::find(stages_.begin(), stages_.end(), stage.name) == stages_.end())
        stages_.push_back(stage.name);
  for (const IterationEvents& iteration : events_.iterations)
    for (const StageEvents& stage : iteration.stages)
      has_external_ = has_external_ || !stage.steps.empty();
  lay_out_legend();
}

const char* Picture::colour_of(std::string_view stage) const {
  const auto at = std::find(stages_.begin(), stages_.end(), stage) - stages_.begin();
  return kStageColours[static_cast<std::size_t>(at) % kStageColours.size()];
}

/// What the cores do, and on new lines the stages.
void Picture::lay_out_legend() {
  double x = kLeftEdge;
  const auto new_line = [&] {
    x = kLeftEdge;
    ++legend_lines_;
  };
  const auto add = [&](std::string name, const char* colour) {
    const double width = 34 + kLetterWidth * static_cast<double>(name.size());
    if (x > kLeftEdge && x + width > kWidth) new_line();
    legend_.push_back({{x, kLegendTop + kLegendStep * static_cast<double>(legend_lines_)},
                       std::move(name),
                       colour});
    x += width;
  };
  for (std::size_t part = 0; part < kParts; ++part)
    if (name_of_part(part) != "accelerator" ||
        sim::has_accelerators(run_.chip.cluster.accelerators))
      add(fmt::format("{}{}", part == 0 || part == kIdle ? "" : "waiting for ", name_of_part(part)),
          kPartColours[part]);
  new_line();
  for (const std::string_view stage : stages_) add(std::string(stage), colour_of(stage));
  if (x > kLeftEdge) new_line();
}

/// From the arrival of the first frame to the last pose, or to the deadline after it.
void Picture::find_span() {
  if (events_.frames.empty()) return;
  begin_ms_ = std::numeric_limits<double>::infinity();
  end_ms_ = -begin_ms_;
  for (const FrameEvents& frame : events_.frames) {
    begin_ms_ = std::min(begin_ms_, static_cast<double>(frame.result.arrival_ns) * 1e-6);
    end_ms_ =
        std::max({end_ms_, static_cast<double>(frame.result.end_ns) * 1e-6,
                  static_cast<double>(frame.result.arrival_ns + run_.frame_period_ns) * 1e-6});
  }
  end_ms_ += 0.01 * (end_ms_ - begin_ms_);
}

void Picture::add_time(Strip& strip, double from_ms, double to_ms, const Shares& shares) const {
  const double column_ms = (end_ms_ - begin_ms_) / static_cast<double>(kColumns);
  const double from = std::max(0.0, (from_ms - begin_ms_) / column_ms);
  const double to = std::min(static_cast<double>(kColumns), (to_ms - begin_ms_) / column_ms);
  for (double at = from; at < to;) {
    const double column = std::floor(at);
    const double end = std::min(to, column + 1);
    for (std::size_t part = 0; part < kParts; ++part)
      strip[static_cast<std::size_t>(column)][part] += (end - at) * shares[part];
    at = end;
  }
}

void Picture::add_core(std::vector<Strip>& strips, const StepEvents& step,
                       const CoreEvents& core) const {
  Strip& strip = strips[static_cast<std::size_t>(core.core)];
  const auto worked = static_cast<double>(core.worked.count());
  Shares shares{};
  if (worked > 0) {
    double waits = 0;
    for (std::size_t i = 0; i < kWaits.size(); ++i)
      waits += shares[i + 1] = std::clamp(kWaits[i].of(core.split) / worked, 0.0, 1.0 - waits);
    shares[0] = 1 - waits;
  }
  add_time(strip, ms(core.begin), ms(core.end), shares);
  if (step.kind != StepKind::Fork || core.core == events_.cores) return;
  Shares idle{};
  idle[kIdle] = 1;
  add_time(strip, ms(core.end), ms(step.end), idle);
}

/// Of the workers, and of the master at the end.
std::vector<Strip> Picture::strips() const {
  std::vector<Strip> result(static_cast<std::size_t>(events_.cores) + 1);
  for (const FrameEvents& frame : events_.frames)
    for (const StageEvents& stage : frame.stages)
      for (const StepEvents& step : stage.steps)
        for (const CoreEvents& core : step.cores) add_core(result, step, core);
  return result;
}

void Picture::draw_legend(Svg& svg) const {
  for (const LegendItem& item : legend_) {
    svg.rectangle({item.at.x, item.at.y, 11, 11}, item.colour);
    svg.text({item.at.x + 16, item.at.y + 10}, item.name, {.size = 11});
  }
}

void Picture::draw_axis(Svg& svg) const {
  const double length = end_ms_ - begin_ms_;
  const double step = tick_step(length, 12);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (int k = 0; k * step <= length; ++k) {
    const double x = x_of(begin_ms_ + k * step);
    svg.line({x, top() - 4}, {x, bottom()}, "#e4e8ec", 1);
    svg.text({x, bottom() + 15}, fmt::format("{:.{}f}", k * step, decimals),
             {.size = 11, .anchor = "middle"});
  }
  svg.text({kLeftEdge + kPlotWidth / 2, bottom() + 33},
           "ms since the arrival of the first frame shown", {.size = 12, .anchor = "middle"});
}

void Picture::draw_label(Svg& svg, std::size_t row, std::string_view name) const {
  svg.text({kLeftEdge - 8, row_top(row) + 14}, name, {.size = 11, .anchor = "end"});
}

/// Its name stands in it where there is room.
void Picture::draw_block(Svg& svg, std::size_t row, double from_ms, double to_ms,
                         std::string_view name, std::string_view colour) const {
  const SvgBox box{x_of(from_ms), row_top(row), x_of(to_ms) - x_of(from_ms), kRowHeight};
  svg.rectangle(box, colour);
  if (box.width > kLetterWidth * static_cast<double>(name.size()))
    svg.text({box.x + 3, box.y + 13}, name, {.size = 10.5, .colour = kInk});
}

void Picture::draw_front_end(Svg& svg) const {
  draw_label(svg, 0, "front end");
  for (const FrameEvents& frame : events_.frames)
    for (const StageEvents& stage : frame.stages)
      draw_block(svg, 0, ms(stage.begin), ms(stage.end), stage.name, colour_of(stage.name));
}

/// Labels stand where they do not reach the one before.
void Picture::draw_deadlines(Svg& svg) const {
  double free_from = 0;
  for (const FrameEvents& frame : events_.frames) {
    const bool late = is_late(frame.result, run_);
    const double x =
        x_of(static_cast<double>(frame.result.arrival_ns + run_.frame_period_ns) * 1e-6);
    svg.line({x, top() - 8}, {x, bottom()}, late ? kMiss : kInk, 1.2, " stroke-dasharray=\"4 3\"");
    const std::string_view label = late ? "deadline missed" : "deadline";
    if (x - 4 - kLetterWidth * static_cast<double>(label.size()) < free_from) continue;
    free_from = x;
    svg.text({x - 4, top() - 5}, label,
             {.size = 10.5, .anchor = "end", .colour = late ? kMiss : kInk});
  }
}

/// One area for each part, on top of those before it.
void Picture::draw_strip(Svg& svg, std::size_t row, const Strip& strip) const {
  const auto height = [](double share) { return std::round(share * kRowHeight / kStep) * kStep; };
  std::array<double, kColumns> below{};
  const double base = row_top(row) + kRowHeight;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<SvgBox> boxes;
    std::array<double, kColumns> above = below;
    for (std::size_t i = 0; i < kColumns; ++i) above[i] += strip[i][part];
    for (std::size_t begin = 0; begin < kColumns;) {
      const double low = height(below[begin]);
      const double high = height(above[begin]);
      std::size_t end = begin + 1;
      while (end < kColumns && height(below[end]) == low && height(above[end]) == high) ++end;
      if (high > low)
        boxes.push_back({kLeftEdge + kColumn * static_cast<double>(begin), base - high,
                         kColumn * static_cast<double>(end - begin), high - low});
      begin = end;
    }
    svg.rectangles(boxes, kPartColours[part]);
    below = above;
  }
}

void Picture::draw_cores(Svg& svg) const {
  const std::vector<Strip> list = strips();
  draw_label(svg, 1, "master");
  draw_strip(svg, 1, list.back());
  for (std::size_t core = 0; core + 1 < list.size(); ++core) {
    draw_label(svg, core + 2, fmt::format("core {}", core));
    draw_strip(svg, core + 2, list[core]);
  }
}

/// @param row  of what goes inwards; what the DMA brings outwards has the next one
void Picture::draw_transfers(Svg& svg, const StageEvents& stage, std::size_t row) const {
  for (const StepEvents& step : stage.steps)
    for (const TransferEvents& transfer : step.transfers)
      if (const double to = std::min(ms(transfer.end), end_ms_); ms(transfer.begin) < to)
        draw_block(svg, row + (transfer.direction == work::Direction::L1ToL2 ? 1 : 0),
                   ms(transfer.begin), to, "", "#5c6670");
}

void Picture::draw_transfers(Svg& svg) const {
  const std::size_t row = static_cast<std::size_t>(events_.cores) + 2;
  draw_label(svg, row, "DMA, to L1");
  draw_label(svg, row + 1, "DMA, to L2");
  for (const FrameEvents& frame : events_.frames)
    for (const StageEvents& stage : frame.stages) draw_transfers(svg, stage, row);
  if (!has_external_) return;
  draw_label(svg, row + 2, "external");
  for (const IterationEvents& iteration : events_.iterations)
    for (const StageEvents& stage : iteration.stages) draw_transfers(svg, stage, row + 2);
}

void Picture::draw_controller(Svg& svg) const {
  draw_label(svg, rows() - 1, "controller");
  for (const IterationEvents& iteration : events_.iterations) {
    const double from = ms(iteration.begin);
    const double to = std::min(ms(iteration.end), end_ms_);
    if (from < to)
      draw_block(svg, rows() - 1, from, to, fmt::format("iteration {}", iteration.iteration),
                 kIterationColours[static_cast<std::size_t>(iteration.iteration) % 2]);
  }
}

std::string Picture::draw() {
  const std::string title =
      fmt::format("{} on {}, {} cores", run_.profile, run_.chip.name, run_.cores);
  Svg svg(kWidth, bottom() + 44, title);
  svg.text({kLeftEdge, 24}, title, {.size = 15, .bold = true});
  draw_legend(svg);
  draw_axis(svg);
  draw_front_end(svg);
  draw_cores(svg);
  draw_transfers(svg);
  draw_controller(svg);
  draw_deadlines(svg);
  return svg.str();
}

}  // namespace

std::string timeline_picture(const TimelineEvents& events, const RunResult& run) {
  return Picture(events, run).draw();
}

}  // namespace leviosim::tools
