#include "tools/app/comparison/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/text.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/comparison/main_causes.h"
#include "tools/app/record/record.h"
#include "tools/app/result/verdict.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

Json quantity_json(const ComparedQuantity& q) {
  Json json;
  json["name"] = q.name;
  json["unit"] = q.unit;
  json["a"] = value_of(q.a);
  json["b"] = value_of(q.b);
  json["difference"] = value_of(q.difference());
  for (const ComparedQuantity& part : q.parts) json["parts"].push_back(quantity_json(part));
  return json;
}

Json list_json(const std::vector<ComparedQuantity>& list) {
  Json json = Json::array();
  for (const ComparedQuantity& q : list) json.push_back(quantity_json(q));
  return json;
}

Json stage_json(const StageComparison& s) {
  Json json;
  json["name"] = s.stage.name;
  json["key"] = s.stage.key;
  json["runs_on"] = s.stage.on_controller ? "controller" : "cluster";
  json["same_work"] = s.same_work;
  for (const auto& [key, quantity] : {std::pair{"calls", &s.calls},
                                      {"operations", &s.operations},
                                      {"single", &s.single},
                                      {"parallel", &s.parallel},
                                      {"share", &s.share}})
    json[key] = quantity_json(*quantity);
  if (!s.mechanisms) return json;
  json["causes"] = {
      {"work", s.causes.work}, {"cost", s.causes.cost}, {"contention", s.causes.contention}};
  json["by_mechanism"] = quantity_json(*s.mechanisms);
  json["by_fork"] = quantity_json(*s.forks);
  return json;
}

class CsvRows {
 public:
  void add(const std::string& subject, const std::string& quantity, const ComparedQuantity& q,
           const std::string& part = {}, const std::string& subpart = {}) {
    table_.add({printable(subject), printable(quantity), printable(part), printable(subpart),
                printable(q.unit), q.a, q.b, q.difference()});
    for (const ComparedQuantity& below : q.parts)
      add(subject, quantity, below, part.empty() ? below.name : part,
          part.empty() ? "" : below.name);
  }
  std::string text() const { return csv_text(table_); }

 private:
  Table table_{{{.key = "subject"},
                {.key = "quantity"},
                {.key = "part"},
                {.key = "subpart"},
                {.key = "unit"},
                {.key = "a"},
                {.key = "b"},
                {.key = "difference"}}};
};

// What fits on a screen of a comparison: figures of the run, the stages that differ most, and why.

constexpr std::size_t kMostFigures = 6;
constexpr std::size_t kMostStages = 4;
constexpr std::size_t kMostCauses = 5;
constexpr double kPerKilo = 1e3;
/// Of the whole difference: a cause with less goes without saying.
constexpr double kLeastCause = 0.02;

std::string screen_line(const std::string& text) { return shortened(text, kScreenColumns) + '\n'; }

/// With the settings that the other run does not have. The name last, which may be long.
std::string described(std::string_view letter, const RunRecord& run, const RunRecord& other) {
  const RunFacts& f = run.facts;
  std::string text = fmt::format("{}  {}", letter, printable(f.profile)) +
                     (f.platform.empty() ? " on the host" : " on " + printable(f.platform));
  const auto add = [&](const std::vector<std::string>& sets,
                       const std::vector<std::string>& others) {
    for (const std::string& set : sets)
      if (std::find(others.begin(), others.end(), set) == others.end())
        text += ", " + printable(set);
  };
  add(f.workload, other.facts.workload);
  add(f.overrides, other.facts.overrides);
  if (f.cores > 0) text += fmt::format(", {} cores", f.cores);
  if (!f.camera.empty()) text += ", camera at " + printable(f.camera);
  return screen_line(text + ": " + printable(run.name));
}

std::string verdicts_in_words(const RunRecord& run) {
  std::string words;
  for (const RunVerdict& verdict : run.verdicts.list)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", verdict.about, verdict.word());
  return words;
}

std::string verdict_line(const RunComparison& c) {
  const std::string a = verdicts_in_words(c.a);
  const std::string b = verdicts_in_words(c.b);
  if (a == b) return screen_line("verdicts: " + a);
  return screen_line("verdicts A: " + a) + screen_line("         B: " + b);
}

/// Those that differ, in their order, after the mean frame.
std::string figure_lines(const RunComparison& c) {
  Table table({{"", kLeft}, {"A"}, {"B"}, {"unit", kLeft}, {"change"}});
  std::size_t rows = 0;
  for (const ComparedQuantity& q : c.figures) {
    const bool is_first = &q == &c.figures.front();
    if ((q.a == q.b && !is_first) || rows == kMostFigures) continue;
    ++rows;
    const int decimals = q.unit == "m" || q.unit == "mJ" ? 3 : q.unit == "ms" ? 2 : 1;
    table.add({q.name, figure_text(q.a, decimals), figure_text(q.b, decimals), q.unit,
               q.percent() ? fmt::format("{:+.1f} %", *q.percent()) : kNothing});
  }
  return terminal_text(table, kScreenColumns);
}

/// Those whose part of a frame differs most.
std::string stages_of_summary(const RunComparison& c) {
  std::vector<const ComparedQuantity*> stages;
  const auto size = [](const ComparedQuantity* q) {
    return std::abs(q->b.value_or(0) - q->a.value_or(0));
  };
  for (const ComparedQuantity& stage : c.frame.parts)
    if (size(&stage) >= 0.05 * kPerKilo) stages.push_back(&stage);
  if (stages.empty()) return {};
  std::stable_sort(stages.begin(), stages.end(),
                   [&](const auto* x, const auto* y) { return size(x) > size(y); });
  Table table({{"kcycles of a mean frame", kLeft}, {"A"}, {"B"}, {"change"}});
  for (std::size_t i = 0; i < std::min(stages.size(), kMostStages); ++i)
    table.add({shortened(stages[i]->name, 30), figure_text(*stages[i]->a / kPerKilo, 1),
               figure_text(*stages[i]->b / kPerKilo, 1),
               stages[i]->percent() ? fmt::format("{:+.1f} %", *stages[i]->percent()) : kNothing});
  return terminal_text(table, kScreenColumns);
}

std::vector<std::string> cause_lines(const RunComparison& c) {
  if (c.a.cycles.empty() || c.b.cycles.empty())
    return {screen_line("where the cycles of one of the runs went is not known; replay its trace")};
  std::vector<std::string> lines;
  const std::vector<MainCause> causes = main_causes(timed_parts(c.a), timed_parts(c.b));
  double most = 0;
  for (const MainCause& cause : causes) most = std::max(most, std::abs(cause.ms));
  for (const MainCause& cause : causes)
    if (lines.size() < kMostCauses && std::abs(cause.ms) >= kLeastCause * most &&
        std::abs(cause.ms) >= 0.005)
      lines.push_back(screen_line("  " + cause_text(cause)));
  if (!lines.empty())
    lines.insert(lines.begin(), screen_line("why a mean frame takes another time:"));
  const std::string unused = unused_text(unused_accelerators(c.a), unused_accelerators(c.b));
  if (!unused.empty())
    lines.push_back(wrap({unused.substr(0, unused.find(", because")) + ",",
                          unused.substr(unused.find("because"))},
                         " ", 2, kScreenColumns) +
                    '\n');
  if (lines.empty()) lines.push_back(screen_line("no stage differs"));
  return lines;
}

/// "in short: B takes 41.60 ms for a mean frame, A 41.94 (-0.8 %)"
std::string conclusion(const RunComparison& c) {
  if (c.figures.empty()) return screen_line("in short: no figure is in both");
  const ComparedQuantity& first = c.figures.front();
  const int decimals = first.unit == "ms" ? 2 : 3;
  return screen_line(
      fmt::format("in short: {}: A {}, B {} {}{}", first.name, figure_text(first.a, decimals),
                  figure_text(first.b, decimals), first.unit,
                  first.percent() ? fmt::format(" ({:+.1f} %)", *first.percent()) : ""));
}

}  // namespace

Json comparison_json(const RunComparison& c) {
  Json json;
  json["format"] = "leviosim comparison";
  json["version"] = 1;
  for (const auto& [key, run] : {std::pair{"a", &c.a}, {"b", &c.b}}) {
    json[key]["name"] = run->name;
    json[key]["facts"] = facts_json(run->facts);
  }
  json["notes"] = c.notes;
  json["same_work"] = c.same_work();
  json["figures"] = list_json(c.figures);
  if (c.a.facts.measured || c.b.facts.measured)
    for (const ModelError& e : model_errors(c))
      json["model_errors"].push_back({{"stage", e.stage},
                                      {"measured", value_of(e.measured)},
                                      {"model", value_of(e.model)},
                                      {"percent", value_of(e.percent)}});
  json["stages"] = Json::array();
  for (const StageComparison& s : c.stages) json["stages"].push_back(stage_json(s));
  json["frame"] = quantity_json(c.frame);
  json["blocks"] = list_json(c.blocks);
  json["energy_by_stage"] = quantity_json(c.energy_by_stage);
  json["energy_by_domain"] = quantity_json(c.energy_by_domain);
  return json;
}

std::string comparison_csv(const RunComparison& c) {
  CsvRows rows;
  for (const ComparedQuantity& q : c.figures) rows.add("run", q.name, q);
  for (const StageComparison& s : c.stages) {
    for (const ComparedQuantity* q : {&s.calls, &s.operations, &s.single, &s.parallel, &s.share})
      rows.add(s.stage.name, q->name, *q);
    if (!s.mechanisms) continue;
    rows.add(s.stage.name, "cycles of a frame by mechanism", *s.mechanisms);
    rows.add(s.stage.name, "cycles of a frame by fork", *s.forks);
    for (const auto& [name, cycles] : {std::pair{"work", s.causes.work},
                                       {"cost", s.causes.cost},
                                       {"contention", s.causes.contention}})
      rows.add(s.stage.name, "cycles of a frame by cause", {name, "cycles", 0.0, cycles}, name);
  }
  for (const ComparedQuantity& q : c.blocks) rows.add("memory", q.name, q);
  rows.add("energy", "by stage", c.energy_by_stage);
  rows.add("energy", "by domain", c.energy_by_domain);
  return rows.text();
}

std::string comparison_summary(const RunComparison& c) {
  if (c.a.facts.measured || c.b.facts.measured) return measured_report(c, false);
  std::string text = described("A", c.a, c.b) + described("B", c.b, c.a);
  for (const std::string& note : c.notes) text += screen_line("note: " + printable(note));
  text += screen_line(work_line(c)) + verdict_line(c) + figure_lines(c) + stages_of_summary(c);
  const auto count = [](const std::string& of) {
    return static_cast<int>(std::count(of.begin(), of.end(), '\n'));
  };
  const std::string end =
      conclusion(c) + "next: the same with --all, or with --report compare.html\n";
  for (const std::string& cause : cause_lines(c))
    if (count(text) + count(cause) + count(end) <= kScreenLines) text += cause;
  return text + end;
}

// A model against a measurement: the error of each stage.

std::vector<ModelError> model_errors(const RunComparison& c) {
  const bool is_a_reference = c.a.facts.measured;
  std::vector<ModelError> errors;
  const auto add = [&](const std::string& name, const std::optional<double>& a,
                       const std::optional<double>& b) {
    errors.push_back({name, is_a_reference ? a : b, is_a_reference ? b : a, std::nullopt});
    ModelError& e = errors.back();
    if (e.measured && e.model && *e.measured != 0)
      e.percent = 100 * (*e.model - *e.measured) / *e.measured;
  };
  for (const StageComparison& s : c.stages) add(s.stage.name, s.parallel.a, s.parallel.b);
  add("frame", c.frame.a, c.frame.b);
  return errors;
}

std::string measured_report(const RunComparison& c, bool markdown) {
  const bool is_a_reference = c.a.facts.measured;
  const RunRecord& measured = is_a_reference ? c.a : c.b;
  const RunRecord& other = is_a_reference ? c.b : c.a;
  const char* const what = other.facts.measured ? "other" : "model";
  const std::string bullet = markdown ? "- " : "";
  std::string text;
  const auto line = [&](const std::string& words) {
    text += bullet + (markdown ? markdown_text(words) : shortened(words, kScreenColumns)) + '\n';
  };
  line("measured: " + printable(measured.name));
  line(fmt::format("{}: {}", what, printable(other.name)));
  for (const std::string& note : c.notes) line("note: " + printable(note));
  Table table({{"kcycles of a call", kLeft}, {"measured"}, {what}, {"error"}});
  std::vector<std::string> missing;
  double sum = 0;
  std::size_t stages = 0;
  const ModelError* worst = nullptr;
  const std::vector<ModelError> errors = model_errors(c);
  const auto kilo = [](std::optional<double> v) {
    return figure_text(v ? std::optional(*v / 1e3) : v, 1);
  };
  for (const ModelError& e : errors) {
    const bool is_frame = &e == &errors.back();
    if (!e.measured) {
      if (!is_frame && e.model) missing.push_back(printable(e.stage));
      continue;
    }
    table.add({shortened(e.stage, 30), kilo(e.measured), kilo(e.model),
               e.percent ? fmt::format("{:+.2f} %", *e.percent) : kNothing});
    if (is_frame || !e.percent) continue;
    ++stages;
    sum += std::abs(*e.percent);
    if (worst == nullptr || std::abs(*e.percent) > std::abs(*worst->percent)) worst = &e;
  }
  text += (markdown ? "\n" + markdown_table(table) + "\n" : terminal_text(table));
  if (!missing.empty()) {
    missing.front().insert(0, "not measured: ");
    for (std::size_t i = 0; i + 1 < missing.size(); ++i) missing[i] += ',';
    const std::string lines = wrap(missing, " ", 2, kScreenColumns) + '\n';
    text += markdown ? "\n" + markdown_text(lines.substr(0, lines.size() - 1)) + '\n' : lines;
  }
  if (worst == nullptr) return text + "in short: no stage is in both\n";
  return text +
         wrap({fmt::format("in short: {:.2f} % off on average of {} stages,",
                           sum / static_cast<double>(stages), stages),
               fmt::format("most in {} ({:+.2f} %)",
                           markdown ? markdown_text(worst->stage) : printable(worst->stage),
                           *worst->percent)},
              " ", 2, kScreenColumns) +
         (markdown ? "\n" : "\nnext: the same with --json, or both in leviosim check --baseline\n");
}

}  // namespace leviosim::tools
