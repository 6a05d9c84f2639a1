// The resolved platform as a platform file.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/new_platform.h"
#include "platform_models/loader/override.h"
#include "platform_models/loader/parameter_units.h"
#include "platform_models/loader/schema.h"
#include "sim/base/check.h"
#include "sim/base/text.h"

namespace leviosim::platform {
namespace {

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += c;
  }
  return out + '"';
}

/// The parameters of one map of the file: one, or the columns of a row.
struct Record {
  std::string path;
  std::vector<std::pair<const Field*, const Parameter*>> columns;
};

std::vector<Record> records_of(const Schema& schema, const ResolvedPlatform& platform) {
  std::vector<Record> records;
  for (const Parameter& parameter : platform.parameters) {
    const std::size_t index = schema.find(parameter.path);
    check(index != Schema::kNone, "a resolved parameter is not in the schema");
    const Field& field = schema.fields()[index];
    if (records.empty() || records.back().path != field.record)
      records.push_back({field.record, {}});
    records.back().columns.push_back({&field, &parameter});
  }
  return records;
}

/// What the file says of the record. Columns that -p changed have other sources.
std::string original_source_of(const Record& record) {
  for (const auto& [field, parameter] : record.columns)
    if (!parameter->overridden) return parameter->source;
  return record.columns.front().second->source;
}

/// A record has one source. If some of its columns were changed, it names them.
std::string source_of(const Record& record) {
  const std::string original = original_source_of(record);
  std::vector<std::pair<std::string, std::string>> changed;  // source → columns
  bool rest = false;
  for (const auto& [field, parameter] : record.columns) {
    if (!parameter->overridden) {
      rest = true;
    } else if (!changed.empty() && changed.back().first == parameter->source) {
      changed.back().second += fmt::format(", {}", field->name);
    } else {
      changed.emplace_back(parameter->source, field->name);
    }
  }
  if (changed.empty()) return original;
  if (!rest && changed.size() == 1) return changed.front().first;
  std::string text;
  for (const auto& [source, columns] : changed)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", source, columns);
  return rest ? fmt::format("{}; the rest: {}", text, original) : text;
}

std::string confidence_of(const Record& record) {
  for (const auto& [field, parameter] : record.columns)
    if (parameter->overridden) return parameter->confidence;
  return record.columns.front().second->confidence;
}

std::string line_of(const Record& record) {
  std::string out;
  std::string unit;
  std::string ranges;
  for (const auto& [field, parameter] : record.columns) {
    out += fmt::format("{}: {}, ", field->name, parameter->value);
    if (!parameter->unit.empty()) unit = fmt::format("unit: {}, ", parameter->unit);
    if (const auto& range = parameter->range)
      ranges += fmt::format(", {}: [{}, {}]", field->range_key(), number_text(range->low),
                            number_text(range->high));
  }
  const std::string& note = record.columns.front().second->note;
  return fmt::format("{{ {}{}source: {}, confidence: {}{}{} }}", out, unit,
                     in_quotes(source_of(record)), confidence_of(record), ranges,
                     note.empty() ? "" : ", note: " + in_quotes(note));
}

/// Writes nested sections: each line opens those that the record before was not in.
class SectionWriter {
 public:
  /// @param before,after  a comment on a line of its own, and one behind the record; none if empty
  void add(const Record& record, std::string_view before = {}, std::string_view after = {}) {
    const std::vector<std::string> parts = base::split(record.path, '.');
    const std::size_t depth = parts.size() - 1;
    std::size_t same = 0;
    while (same < depth && same < open_.size() && open_[same] == parts[same]) ++same;
    for (std::size_t level = same; level < depth; ++level)
      out_ += fmt::format("{:{}}{}:\n", "", 2 * level, parts[level]);
    if (!before.empty()) out_ += fmt::format("{:{}}# {}\n", "", 2 * depth, before);
    out_ += fmt::format("{:{}}{}: {}{}{}\n", "", 2 * depth, parts[depth], line_of(record),
                        after.empty() ? "" : "  # ", after);
    open_.assign(parts.begin(), parts.end() - 1);
  }
  const std::string& text() const { return out_; }

 private:
  std::vector<std::string> open_;
  std::string out_;
};

std::string head_of(const std::string& name, const std::string& description,
                    const ResolvedPlatform& platform) {
  std::string out = fmt::format("name: {}\ndescription: {}\n\nsources:\n", in_quotes(name),
                                in_quotes(description));
  for (const auto& [key, meaning] : platform.sources)
    out += fmt::format("  {}: {}\n", in_quotes(key), in_quotes(meaning));
  return out;
}

/// A kind of dependence, and which parameters have it.
struct DependenceRule : Dependence {
  std::vector<std::string_view> units;  ///< of all quantities in them …
  std::vector<std::string_view>
      paths;  ///< … and of these, which are ends of paths or whole sections
};

/// Cycles of what lies behind a core's own memory pass at the clock of a bus or a memory; an energy
/// is that of a cell at a voltage; and an access of a larger memory takes longer, and more energy.
const std::vector<DependenceRule>& rules() {
  static const std::vector<DependenceRule> kRules = {
      {{"clock",
        "clocks, and cycles that are the time of a memory or a bus with a clock of its own"},
       {"MHz", "GHz", "kHz", "Hz"},
       {"icache.shared_miss", "icache.miss", "icache.refill_width", "dma.first_data",
        "dma.bytes_per_cycle", "ops.load_l2", "ops.store_l2", "events.offload"}},
      {{"voltage", "energies, leakage, and clocks that a supply allows"},
       {"V", "mV", "J", "uJ", "nJ", "pJ", "fJ", "W", "mW", "uW", "nW"},
       {"supply", "leakage_exponent"}},
      {{"memory",
        "sizes, and what an access takes in a memory of that size, number of banks and place"},
       {"MiB", "KiB", "MB", "kB"},
       {"l1.banks", "l1.stream_conflicts", "icache.shared_banks", "icache.shared_hit",
        "icache.shared_miss", "icache.miss", "ops.load_l2", "ops.store_l2", "dma.first_data",
        "energy.l1", "energy.l2", "l1_leakage", "l2_leakage", "external"}}};
  return kRules;
}

/// "events.offload" is at the end of a path, or of the section that holds it.
bool is_on(const std::string& path, std::string_view part) {
  return ('.' + path + '.').find('.' + std::string(part) + '.') != std::string::npos;
}

std::string marks_text(const Record& record) {
  std::string text;
  for (const DependenceRule& rule : rules()) {
    const auto has = [&](const auto& column) {
      const std::vector<std::string_view> marks = marks_of(*column.second);
      return std::find(marks.begin(), marks.end(), rule.mark) != marks.end();
    };
    if (std::any_of(record.columns.begin(), record.columns.end(), has))
      text += fmt::format("{}({})", text.empty() ? "" : " ", rule.mark);
  }
  return text;
}

}  // namespace

std::vector<Dependence> dependences() { return {rules().begin(), rules().end()}; }

std::vector<std::string_view> marks_of(const Parameter& parameter) {
  std::vector<std::string_view> marks;
  for (const DependenceRule& rule : rules())
    if (std::find(rule.units.begin(), rule.units.end(), parameter.unit) != rule.units.end() ||
        std::any_of(rule.paths.begin(), rule.paths.end(),
                    [&](std::string_view part) { return is_on(parameter.path, part); }))
      marks.push_back(rule.mark);
  return marks;
}

std::string new_platform(const std::string& name, const ResolvedPlatform& from,
                         const std::string& from_name) {
  const Schema schema;
  std::string out = fmt::format(
      "# {0}, begun with everything of {1}. Change what differs: a number takes its unit, a source "
      "and a\n"
      "# confidence with it. Of a chip that differs in a few numbers only, a file with `extends: "
      "{1}` and these\n"
      "# numbers is enough. Behind a number that was taken over stands what it depends on:\n",
      name, from_name);
  for (const Dependence& d : dependences()) out += fmt::format("#   ({}) {}\n", d.mark, d.meaning);
  out += head_of(name, fmt::format("begun with {}", from.name), from);
  SectionWriter sections;
  for (const Record& record : records_of(schema, from))
    sections.add(record, record.columns.front().first->description, marks_text(record));
  return out + "\n" + sections.text();
}

std::string to_yaml(const ResolvedPlatform& platform) {
  const Schema schema;
  const std::string out = head_of(platform.name, platform.description, platform);
  SectionWriter sections;
  for (const Record& record : records_of(schema, platform)) sections.add(record);
  return out + "\n" + sections.text();
}

}  // namespace leviosim::platform
