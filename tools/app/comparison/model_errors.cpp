#include "tools/app/comparison/model_errors.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/base/printable.h"
#include "tools/app/cli/screen.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/record/record.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

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
