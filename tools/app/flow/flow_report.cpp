#include "tools/app/flow/flow_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "tools/app/report/energy_tables.h"
#include "tools/app/report/number_text.h"
#include "tools/app/report/tables.h"
#include "tools/app/report/text_table.h"
#include "tools/app/result/energy.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

constexpr double kPixel = 1 << 8;

std::vector<PublishedFlow> published_of(const FlowRun& flow) {
  std::vector<PublishedFlow> rows = published_flow();
  std::erase_if(rows, [&](const PublishedFlow& row) { return row.platform != flow.platform; });
  return rows;
}

std::string figure_text(const PublishedFlow& row) {
  std::string text(name_of(row.figure));
  if (row.rate) text += fmt::format(" at {:g} frames/s", *row.rate);
  return text;
}

double rate_of(const FlowRun& flow) {
  return flow.rate.value_or(1e9 / static_cast<double>(flow.run.frame_period_ns));
}

}  // namespace

std::string frame_rate_table(const FlowRun& flow) {
  const std::optional<FlowCycles> cycles = flow_cycles(flow.run);
  if (!cycles) return {};
  const double hertz = static_cast<double>(flow.run.cluster_clock.count());
  TextTable table({{"cores"}, {"kcycles of a frame"}, {"frames/s"}, {"speed-up"}});
  table.add({"1", fmt::format("{:.2f}", cycles->single * 1e-3),
             fmt::format("{:.1f}", hertz / cycles->single), "1.00"});
  if (flow.run.cores > 1)
    table.add({fmt::format("{}", flow.run.cores), fmt::format("{:.2f}", cycles->parallel * 1e-3),
               fmt::format("{:.1f}", hertz / cycles->parallel),
               fmt::format("{:.2f}", cycles->single / cycles->parallel)});
  return fmt::format("frames that the chip could do at {:g} MHz, offload included\n",
                     megahertz(flow.run.cluster_clock)) +
         table.str();
}

std::string published_table(const FlowRun& flow) {
  const std::vector<PublishedFlow> rows = published_of(flow);
  if (rows.empty()) return {};
  TextTable table({{"figure", kLeft},
                   {"cores"},
                   {"MHz"},
                   {"unit", kLeft},
                   {"published"},
                   {"here"},
                   {"difference %"},
                   {"source", kLeft}});
  for (const PublishedFlow& row : rows) {
    const std::optional<double> here = predicted(row, flow.run);
    table.add(
        {figure_text(row), fmt::format("{}", row.cores), fmt::format("{:g}", row.clock_mhz),
         row.unit, fmt::format("{:g}", row.value), here ? fmt::format("{:.4g}", *here) : kNothing,
         here ? fmt::format("{:+.1f}", 100 * (*here / row.value - 1)) : kNothing, row.source});
  }
  return "published figures (all clocks in proportion, the same cycles)\n" + table.str();
}

std::string flow_summary(const FlowRun& flow) {
  std::int64_t with_flow = 0;
  double quality = 0, textured = 0, matched = 0, length = 0;
  for (const flow::Flow& f : flow.flows) {
    textured += f.textured;
    matched += f.matched;
    if (f.quality == 0) continue;
    ++with_flow;
    quality += f.quality;
    length += std::hypot(f.x / kPixel, f.y / kPixel);
  }
  const auto pairs = static_cast<double>(std::max<std::size_t>(flow.flows.size(), 2) - 1);
  std::string text = fmt::format(
      "optical flow: {} frames, {} with a flow; of a pair of frames {:.1f} blocks have texture, "
      "{:.1f} a match\n",
      flow.flows.size(), with_flow, textured / pairs, matched / pairs);
  if (with_flow > 0)
    text += fmt::format("              mean quality {:.0f} of 255, mean length {:.2f} px\n",
                        quality / static_cast<double>(with_flow),
                        length / static_cast<double>(with_flow));
  return text;
}

std::vector<std::string> flow_report(const FlowRun& flow) {
  const RunResult timed = at_rate(flow.run, rate_of(flow));
  std::string others;
  for (const std::string& lines :
       {breakdown_table(timed), memory_table(timed), energy_table(timed), power_table(timed),
        flow_summary(flow)})
    if (!lines.empty()) others += lines + '\n';
  std::vector<std::string> parts{stage_table(timed) + '\n', frame_rate_table(flow) + '\n'};
  if (const std::string published = published_table(flow); !published.empty())
    parts.push_back(published + '\n');
  parts.push_back(others + host_line(flow.run));
  return parts;
}

std::string flow_conclusion(const FlowRun& flow) {
  const std::optional<FlowCycles> cycles = flow_cycles(flow.run);
  if (!cycles || cycles->parallel == 0) return "verdict: no frames";
  const double most = static_cast<double>(flow.run.cluster_clock.count()) / cycles->parallel;
  const bool keeps_up = most >= rate_of(flow);
  return fmt::format("verdict: {}: {} cores could do {:.0f} frames/s, the camera sends {:.0f}",
                     keeps_up ? "fits" : "too slow", flow.run.cores, most, rate_of(flow));
}

std::string flow_csv(const FlowRun& flow) {
  std::string text =
      "frame,t_ns,dx_px,dy_px,quality,textured,matched,parallel_cycles,single_cycles\n";
  for (std::size_t i = 0; i < flow.flows.size(); ++i) {
    const flow::Flow& f = flow.flows[i];
    const FrameResult& frame = flow.run.frames[i];
    text += fmt::format("{},{},{:.4f},{:.4f},{},{},{},{},{}\n", frame.index, frame.t_ns,
                        f.x / kPixel, f.y / kPixel, f.quality, f.textured, f.matched,
                        frame.cycles.count(), frame.single_cycles.count());
  }
  return text;
}

std::string published_csv(const FlowRun& flow) {
  std::string text = "platform,figure,cores,clock_mhz,rate,unit,published,here\n";
  for (const PublishedFlow& row : published_of(flow)) {
    const std::optional<double> here = predicted(row, flow.run);
    text += fmt::format("{},{},{},{:g},{},{},{:g},{}\n", row.platform, name_of(row.figure),
                        row.cores, row.clock_mhz, row.rate ? fmt::format("{:g}", *row.rate) : "",
                        row.unit, row.value, here ? fmt::format("{:.6g}", *here) : "");
  }
  return text;
}

}  // namespace leviosim::tools
