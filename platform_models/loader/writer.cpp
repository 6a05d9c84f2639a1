// The resolved platform as a platform file.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/override.h"
#include "platform_models/loader/schema.h"
#include "platform_models/loader/variants.h"
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

/// Changed since the file was read, by -p or by a calibration.
bool is_changed(const Parameter& parameter, const std::string& original) {
  return parameter.overridden || parameter.source != original;
}

/// What the file says of the record. Changed columns have other sources.
std::string original_source_of(const Record& record) {
  const auto begins_with = [](const std::string& text, std::string_view start) {
    return text.rfind(start, 0) == 0;
  };
  for (const auto& [field, parameter] : record.columns)
    if (!parameter->overridden && !begins_with(parameter->source, kCalibrated))
      return parameter->source;
  return record.columns.front().second->source;
}

/// A record has one source. If some of its columns were changed, it names them.
std::string source_of(const Record& record) {
  const std::string original = original_source_of(record);
  std::vector<std::pair<std::string, std::string>> changed;  // source → columns
  bool rest = false;
  for (const auto& [field, parameter] : record.columns) {
    if (!is_changed(*parameter, original)) {
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
  const std::string original = original_source_of(record);
  for (const auto& [field, parameter] : record.columns)
    if (is_changed(*parameter, original)) return parameter->confidence;
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
  void add(const Record& record) {
    const std::vector<std::string> parts = base::split(record.path, '.');
    const std::size_t depth = parts.size() - 1;
    std::size_t same = 0;
    while (same < depth && same < open_.size() && open_[same] == parts[same]) ++same;
    for (std::size_t level = same; level < depth; ++level)
      out_ += fmt::format("{:{}}{}:\n", "", 2 * level, parts[level]);
    out_ += fmt::format("{:{}}{}: {}\n", "", 2 * depth, parts[depth], line_of(record));
    open_.assign(parts.begin(), parts.end() - 1);
  }
  const std::string& text() const { return out_; }

 private:
  std::vector<std::string> open_;
  std::string out_;
};

}  // namespace

std::string to_yaml(const ResolvedPlatform& platform) {
  const Schema schema;
  std::string out = fmt::format("name: {}\ndescription: {}\n\nsources:\n", in_quotes(platform.name),
                                in_quotes(platform.description));
  for (const auto& [key, meaning] : platform.sources)
    out += fmt::format("  {}: {}\n", in_quotes(key), in_quotes(meaning));
  SectionWriter sections;
  for (const Record& record : records_of(schema, platform)) sections.add(record);
  return out + "\n" + sections.text();
}

}  // namespace leviosim::platform
