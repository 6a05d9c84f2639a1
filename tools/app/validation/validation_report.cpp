#include "tools/app/validation/validation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/as_released.h"
#include "tools/app/validation/distributions.h"
#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/paths.h"
#include "tools/app/validation/run_inputs.h"
#include "tools/app/validation/validation.h"

namespace leviosim::tools {
namespace {

/// As many decimals as make sense for the size of the number.
std::string readable(std::optional<double> value) {
  if (!value) return kNothing;
  const double size = std::abs(*value);
  if (size == std::round(size) && size < 1e7) return fmt::format("{:.0f}", *value);
  return figure_text(value, size >= 1000 ? 0 : size >= 10 ? 1 : 2);
}

std::string error_text(const Comparison& c) {
  if (!c.value) return kNothing;
  if (c.reference.limit && *c.error() == 0) return "kept";
  return c.reference.tolerance.relative ? fmt::format("{:+.1f} %", *c.error())
                                        : fmt::format("{:+.2f}", *c.error());
}

std::string tolerance_text(const Reference& r) {
  if (r.limit && r.tolerance.value == 0) return "";
  return fmt::format("±{:g}{}", r.tolerance.value, r.tolerance.relative ? " %" : "");
}

const char* within_text(const Comparison& c) {
  if (!c.value) return "not covered";
  return std::abs(*c.error()) <= c.reference.tolerance.value ? "yes" : "no";
}

const Comparison* find(const std::vector<Comparison>& comparisons, const std::string& name) {
  for (const Comparison& comparison : comparisons)
    if (comparison.reference.name == name) return &comparison;
  return nullptr;
}

bool is_of_compute_table(const std::string& name) {
  for (const PaperStage& stage : kPaperStages)
    if (name.rfind(fmt::format("compute.{}.", stage.key), 0) == 0) return true;
  return false;
}

void add_cells(std::vector<Cell>& cells, const Comparison* c, int decimals) {
  cells.push_back(c == nullptr ? kNothing : figure_text(c->reference.value, decimals));
  cells.push_back(c == nullptr ? kNothing : figure_text(c->value, decimals));
  cells.push_back(c == nullptr ? kNothing : error_text(*c));
}

/// Of the table above it.
std::string errors_text(const std::vector<Comparison>& comparisons, int cores) {
  const auto error = [&](const char* name) {
    const Comparison* c = find(comparisons, name);
    return c == nullptr ? std::string(kNothing) : figure_text(c->value, 1);
  };
  return fmt::format(
      "mean absolute error {} % on one core, {} % on {} cores; worst on {} cores {} %\n",
      error("error.single.mean"), error("error.multi.mean"), cores, cores,
      error("error.multi.worst"));
}

std::vector<Banded> shown_bands(const std::vector<BandedStage>& stages) {
  std::vector<Banded> bands;
  for (const BandedStage& stage : stages) bands.push_back(stage.weighed.value_or(stage.simulated));
  return bands;
}

constexpr const char* kHowToRead =
    "How to read this: the paper's averages are of 1578 frames whose numbers of features, "
    "landmarks\n"
    "and matches it does not print. RANSAC iterations and pixels are fixed, so these stages "
    "compare\n"
    "directly, up to scoring and describing. Matching compares pairs: its cycles follow the "
    "inputs,\n"
    "and \"needed\" is what a mean call would have to have for the paper's one-core value.\n";

}  // namespace

std::string compute_table(const std::vector<Comparison>& comparisons, int cores) {
  Table table({{"stage", kLeft},
               {"kcycles, 1 core"},
               {"simulated"},
               {"error"},
               {"8 cores", kRight, 1},
               {fmt::format("simulated on {}", cores)},
               {"error"},
               {"speed-up", kRight, 2},
               {"simulated", kRight, 2},
               {"error", kRight, 2}});
  for (const PaperStage& stage : kPaperStages) {
    std::vector<Cell> cells{std::string(stage.title)};
    const std::string path = fmt::format("compute.{}.", stage.key);
    add_cells(cells, find(comparisons, path + "single"), 0);
    add_cells(cells, find(comparisons, path + "multi"), 0);
    add_cells(cells, find(comparisons, path + "speedup"), 2);
    table.add(std::move(cells));
  }
  return terminal_text(table) + errors_text(comparisons, cores);
}

std::string reference_table(const Validation& validation) {
  using C = const Comparison&;
  const Columns<Comparison> table{
      {{"quantity", kLeft}, [](C c) { return c.reference.name; }},
      {{"unit", kLeft}, [](C c) { return c.reference.unit; }},
      {{"paper"},
       [](C c) { return fmt::format("{}{:g}", c.reference.limit ? "< " : "", c.reference.value); }},
      {{"simulated"}, [](C c) { return figure_text(c.value, 2); }},
      {{"error"}, [](C c) { return error_text(c); }},
      {{"tolerance"}, [](C c) { return tolerance_text(c.reference); }},
      {{"within", kLeft}, [](C c) { return within_text(c); }}};
  std::vector<Comparison> rows = validation.comparisons;
  std::erase_if(rows, [](C c) { return is_of_compute_table(c.reference.name); });
  return "shares, latencies, memory and limits (kB of 1000 bytes)\n" +
         terminal_text(table_of(table, rows));
}

std::string input_table(const Validation& validation) {
  using I = const InputFigure&;
  const Columns<InputFigure> table{
      {{"input, mean", kLeft}, [](I i) { return i.name; }},
      {{"unit", kLeft}, [](I i) { return i.unit == "1" ? "" : i.unit; }},
      {{"paper"}, [](I i) { return readable(i.paper); }},
      {{"simulated"}, [](I i) { return readable(i.value); }},
      {{"paper's", kLeft}, [](I i) { return i.source; }}};
  return "what the figures depend on\n" + terminal_text(table_of(table, validation.inputs));
}

std::string distribution_table(const Validation& validation) {
  if (validation.distributions.empty()) return "";
  std::vector<Head> columns{{"input", kLeft}, {"of", kLeft}};
  for (const std::string_view column : kDistributionColumns)
    columns.push_back({std::string(column)});
  Table table(std::move(columns));
  for (const InputDistribution& d : validation.distributions) {
    const auto add = [&](std::string name, std::string program,
                         const InputDistribution::Cells& values) {
      std::vector<Cell> cells{std::move(name), std::move(program)};
      for (const std::optional<double>& value : values) cells.push_back(readable(value));
      table.add(std::move(cells));
    };
    add(d.quantity, "release", d.released);
    add("", "this run", d.simulated);
  }
  return "inputs of the stages on these frames, and of the released program on the 300 of MH_01\n"
         "(percentiles are linear between order statistics; shares are of frames, in per cent)\n" +
         terminal_text(table) + "\n";
}

std::string normalised_table(const Validation& validation, int cores) {
  using N = const NormalisedFigure&;
  const auto whole = [](std::optional<double> units) {
    return readable(units ? std::optional(std::round(*units)) : std::nullopt);
  };
  const Columns<NormalisedFigure> table{
      {{"cycles of", kLeft}, [](N n) { return n.stage; }},
      {{"for a", kLeft}, [](N n) { return n.unit; }},
      {{"1 core"}, [](N n) { return readable(n.single); }},
      {{fmt::format("{} cores", cores)}, [](N n) { return readable(n.parallel); }},
      {{"paper, 1 core"}, [](N n) { return readable(n.paper_per_unit()); }},
      {{"in a call"}, [=](N n) { return whole(n.units); }},
      {{"needed"}, [=](N n) { return whole(n.explaining_units); }}};
  return "cycles for a unit of work, which depend less on the input\n" +
         terminal_text(table_of(table, validation.normalised)) + kHowToRead;
}

std::string path_table(const Validation& validation, int cores) {
  Table table({{"kcycles of", kLeft},
               {"EPnP"},
               {"8-point"},
               {"weighed"},
               {"error"},
               {fmt::format("EPnP, {} cores", cores), kRight, 1},
               {"8-point"},
               {"weighed"},
               {"error"}});
  const auto add = [](std::vector<Cell>& cells, const StageOnPaths::Means& means,
                      const Comparison* paper) {
    for (const std::optional<double>& mean : {means.epnp, means.eight_point, means.weighed})
      cells.push_back(figure_text(mean ? std::optional(*mean / 1e3) : std::nullopt, 0));
    const bool compares = paper != nullptr && means.weighed;
    cells.push_back(compares
                        ? fmt::format("{:+.1f} %", error_of(paper->reference, *means.weighed / 1e3))
                        : kNothing);
  };
  for (const StageOnPaths& stage : validation.paths) {
    std::vector<Cell> cells{std::string(stage.title)};
    add(cells, stage.single,
        find(validation.comparisons, fmt::format("compute.{}.single", stage.key)));
    add(cells, stage.parallel,
        find(validation.comparisons, fmt::format("compute.{}.multi", stage.key)));
    table.add(std::move(cells));
  }
  return fmt::format(
      "stages of frames that run either RANSAC, and weighed as the paper's frames: {:g} and {:g} "
      "%\n"
      "{}",
      kPaperEpnpFrames, kPaperEightPointFrames, terminal_text(table));
}

std::string band_table(const std::vector<BandedStage>& bands, int cores) {
  if (bands.empty()) return "";
  using B = const BandedStage&;
  const auto ends = [](const Banded& b) { return fmt::format("{:.0f} … {:.0f}", b.low, b.high); };
  const Columns<BandedStage> table{
      {{"stage", kLeft}, [](B b) { return b.title; }},
      {{"cores"}, [=](B b) { return b.single ? 1 : cores; }},
      {{"paper"}, [](B b) { return figure_text(b.paper, 0); }},
      {{"this run"}, [](B b) { return figure_text(b.simulated.value, 0); }},
      {{"band"}, [=](B b) { return ends(b.simulated); }},
      {{"weighed"}, [](B b) { return b.weighed ? figure_text(b.weighed->value, 0) : kNothing; }},
      {{"band"}, [=](B b) { return b.weighed ? ends(*b.weighed) : kNothing; }},
      {{"inside", kLeft}, [](B b) { return b.is_inside() ? "yes" : "no"; }}};
  const auto count = [&](auto is) { return std::count_if(bands.begin(), bands.end(), is); };
  return fmt::format(
      "{}{} of {} of the paper's figures lie inside; of this run's own means {}; median half width "
      "{:.1f} %\n\n",
      terminal_text(table_of(table, bands)), count([](B b) { return b.is_inside(); }), bands.size(),
      count([](B b) { return b.simulated.holds(b.paper); }), median_half_width(shown_bands(bands)));
}

std::vector<std::string> validation_report(const Validation& validation, int cores) {
  const auto& second = validation.with_paper_keypoints;
  const std::string fewer = second ? " with our default's number of keypoints" : "";
  const std::string as_paper =
      second
          ? fmt::format(" with about the paper's number of keypoints ({}: {}, {})",
                        readable(second->keypoints ? std::optional(std::round(*second->keypoints))
                                                   : std::nullopt),
                        kPaperKeypoints[0], kPaperKeypoints[1])
          : "";
  constexpr const char* kCompute =
      "compute: the paper's averages and the simulated means over the same kind of frame";
  constexpr const char* kBand =
      "kcycles with the band that the platform's ranges leave, of this run and weighed as the "
      "paper's frames";
  const auto titled = [&](const char* title, const std::string& with, const std::string& table) {
    return table.empty() ? table : title + with + '\n' + table;
  };
  return {
      titled(kCompute, fewer, compute_table(validation.comparisons, cores)) + '\n',
      second ? titled(kCompute, as_paper, compute_table(second->comparisons, cores)) + '\n' : "",
      reference_table(validation) + '\n',
      input_table(validation) + '\n',
      distribution_table(validation),
      normalised_table(validation, cores) + '\n',
      path_table(validation, cores) + '\n',
      titled(kBand, fewer, band_table(validation.bands, cores)),
      second ? titled(kBand, as_paper, band_table(second->bands, cores)) : ""};
}

bool is_worse(const Validation& validation) {
  return std::any_of(validation.comparisons.begin(), validation.comparisons.end(),
                     [](const Comparison& c) { return c.verdict == Verdict::Worse; });
}

std::string validation_conclusion(const Validation& validation) {
  const auto within = std::count_if(
      validation.comparisons.begin(), validation.comparisons.end(), [](const Comparison& c) {
        return c.value && std::abs(*c.error()) <= c.reference.tolerance.value;
      });
  std::string text = fmt::format("{} of {} references within their tolerance", within,
                                 validation.comparisons.size());
  if (!is_worse(validation)) return "verdict: met: " + text + ", no other worse than its guard";
  for (const Comparison& c : validation.comparisons)
    if (c.verdict == Verdict::Worse)
      return fmt::format("verdict: NOT met: {}; first of those that are too far off: {}, {}", text,
                         c.reference.name, error_text(c));
  return text;
}

}  // namespace leviosim::tools
