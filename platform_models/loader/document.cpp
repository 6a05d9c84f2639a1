#include "platform_models/loader/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "platform_models/loader/instruction_set.h"
#include "platform_models/loader/override.h"
#include "platform_models/loader/yaml_entries.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {
namespace {

/// What a record says besides its values.
struct Provenance {
  std::string unit;
  std::string source;
  std::string confidence;
  std::string note;
};

class DocumentReader {
 public:
  DocumentReader(const Schema& schema, const std::string& file) : schema_(schema), file_(file) {
    document_.settings.resize(schema.fields().size());
  }

  /// @param users  the platforms that extend this one, outermost first
  Document read_platform(const std::string& text, const std::optional<BaseOverride>& base,
                         std::vector<std::string> users = {});

 private:
  /// @param users  the files that build on this one, outermost first
  Document read_instruction_set(const std::string& text, std::vector<std::string> users);
  void read_base(const std::vector<YamlEntry>& root, const std::optional<BaseOverride>& base);
  void read_parent(const YamlEntry& extends, const std::vector<YamlEntry>& root,
                   const std::optional<BaseOverride>& base);
  std::vector<std::string> users_of_base(const TextFile& file, const std::string& name,
                                         const Place& named) const;
  void expect_same_sources(const Document& base, const TextFile& file, const Place& named) const;
  Document finish();
  void read_header(const std::vector<YamlEntry>& root);
  void read_sources(const YamlEntry& entry);
  void read_section(const std::vector<YamlEntry>& entries, const std::string& path);
  void read_record(const YamlEntry& entry, const std::string& path);
  void read_bare(const YamlEntry& entry, const std::string& path);
  Provenance read_provenance(const std::vector<YamlEntry>& entries, const std::string& path,
                             const Place& record) const;
  void check_keys(const std::vector<YamlEntry>& entries, const std::string& path) const;
  void check_source(const std::string& source, const Place& place) const;
  void read_field(std::size_t index, const std::vector<YamlEntry>& entries,
                  const Provenance& provenance, int line);
  Range read_range_of(const Field& field, const YamlEntry& entry, const Setting& value) const;
  void check_complete() const;
  Place place(const YamlEntry& entry, const std::string& path) const {
    return place_of(file_, entry.line, path);
  }

  const Schema& schema_;
  std::string file_;
  std::vector<std::string> users_;
  bool extends_ = false;
  std::map<std::string, std::string> sources_of_base_;
  std::map<std::string, int> section_lines_;
  Document document_;
};

/// The source of what a file changes without a word about it.
constexpr const char* kWhatIfKey = "what if";
constexpr const char* kWhatIfMeaning = "assumed, to see what would follow";
constexpr const char* kIsa = "isa";
constexpr const char* kBase = "base";

/// Keys of the root that are about the file as a whole.
bool is_header(std::string_view path) {
  return path == "name" || path == "description" || path == "sources" || path == kParentPath;
}

const YamlEntry* find(const std::vector<YamlEntry>& entries, const std::string& key) {
  for (const YamlEntry& entry : entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

Document DocumentReader::read_platform(const std::string& text,
                                       const std::optional<BaseOverride>& base,
                                       std::vector<std::string> users) {
  users_ = std::move(users);
  const std::vector<YamlEntry> root = entries_of(parse_yaml(file_, text), file_, "");
  extends_ = find(root, kParentPath) != nullptr;
  read_header(root);
  if (const YamlEntry* extends = find(root, kParentPath))
    read_parent(*extends, root, base);
  else
    read_base(root, base);
  read_section(root, "");
  check_complete();
  return finish();
}

Document DocumentReader::read_instruction_set(const std::string& text,
                                              std::vector<std::string> users) {
  users_ = std::move(users);
  const std::vector<YamlEntry> root = entries_of(parse_yaml(file_, text), file_, "");
  read_header(root);
  for (const YamlEntry& entry : root)
    if ((!is_header(entry.key) || entry.key == kParentPath) && entry.key != kIsa)
      place(entry, entry.key)
          .fail(
              "unknown key; an instruction set has name, description, sources "
              "and isa");
  read_base(root, {});
  read_section(root, "");
  return finish();
}

/// Begins with the parameters of the instruction set that this file builds on, if it names one.
void DocumentReader::read_base(const std::vector<YamlEntry>& root,
                               const std::optional<BaseOverride>& other) {
  const YamlEntry* isa = find(root, kIsa);
  const std::vector<YamlEntry> entries =
      isa == nullptr ? std::vector<YamlEntry>{} : entries_of(isa->value, file_, isa->key);
  const YamlEntry* key = find(entries, kBase);
  if (other && key == nullptr)
    Place{other->where}.fail(
        fmt::format("{} names no {} that could be replaced; a chip's own file does, as --platform "
                    "gap9 takes it",
                    file_, kBasePath));
  if (key == nullptr) return;
  const Place named = other ? Place{other->where} : place(*key, kBasePath);
  const std::string name = other ? other->base : scalar(key->value, named);
  const TextFile file = find_instruction_set(name, file_, named);

  Document base = DocumentReader(schema_, file.name)
                      .read_instruction_set(file.text, users_of_base(file, name, named));
  expect_same_sources(base, file, named);
  document_.settings = std::move(base.settings);
  sources_of_base_ = std::move(base.sources);
}

/// Begins with all of another platform. Its sources can be cited.
void DocumentReader::read_parent(const YamlEntry& extends, const std::vector<YamlEntry>& root,
                                 const std::optional<BaseOverride>& base) {
  const Place named = place(extends, kParentPath);
  if (const YamlEntry* isa = find(root, kIsa))
    for (const YamlEntry& entry : entries_of(isa->value, file_, isa->key))
      if (entry.key == kBase)
        place(entry, kBasePath)
            .fail("the platform that this one extends has named its instruction set");
  const std::string name = scalar(extends.value, named);
  const TextFile file = find_platform(name, file_, named);
  Document parent = DocumentReader(schema_, file.name)
                        .read_platform(file.text, base, users_of_base(file, name, named));
  expect_same_sources(parent, file, named);
  document_.settings = std::move(parent.settings);
  document_.sources.merge(parent.sources);
}

std::vector<std::string> DocumentReader::users_of_base(const TextFile& file,
                                                       const std::string& name,
                                                       const Place& named) const {
  std::vector<std::string> users = users_;
  users.push_back(file_);
  if (std::find(users.begin(), users.end(), file.name) != users.end())
    named.fail(fmt::format("'{}' builds on itself", name));
  return users;
}

void DocumentReader::expect_same_sources(const Document& base, const TextFile& file,
                                         const Place& named) const {
  for (const auto& [source, meaning] : base.sources) {
    const auto own = document_.sources.find(source);
    if (own != document_.sources.end() && own->second != meaning)
      named.fail(fmt::format("source '{}' stands for something else in {}", source, file.name));
  }
}

/// What was read, with the sources of the base. (Rows of a file cite its own.)
Document DocumentReader::finish() {
  document_.sources.merge(sources_of_base_);
  return std::move(document_);
}

void DocumentReader::read_header(const std::vector<YamlEntry>& root) {
  const auto text = [&](const std::string& key, std::string_view example,
                        const std::string& otherwise) {
    const YamlEntry* entry = find(root, key);
    if (entry == nullptr && extends_) return otherwise;
    if (entry == nullptr)
      place_of(file_, 1, key).fail(fmt::format("missing key; expected {}: {}", key, example));
    const std::string value = scalar(entry->value, place(*entry, key));
    if (trim(value).empty()) place(*entry, key).fail("is empty");
    return value;
  };
  document_.name =
      text("name", "the name of the chip", std::filesystem::path(file_).stem().string());
  document_.description =
      text("description", "one line about the chip", "what if: another platform, changed");
  const YamlEntry* sources = find(root, "sources");
  if (sources != nullptr)
    read_sources(*sources);
  else if (find(root, kParentPath) == nullptr)
    place_of(file_, 1, "sources").fail("missing key; expected a map of sources");
}

void DocumentReader::read_sources(const YamlEntry& entry) {
  for (const YamlEntry& source : entries_of(entry.value, file_, entry.key))
    document_.sources[source.key] =
        scalar(source.value, place(source, joined(entry.key, source.key)));
}

void DocumentReader::read_section(const std::vector<YamlEntry>& entries, const std::string& path) {
  for (const YamlEntry& entry : entries) {
    const std::string inner = joined(path, entry.key);
    if (is_header(inner) || inner == kBasePath) continue;
    if (schema_.is_section(inner)) {
      section_lines_[inner] = entry.line;
      read_section(entries_of(entry.value, file_, inner), inner);
    } else if (!schema_.record(inner).empty()) {
      read_record(entry, inner);
    } else {
      place(entry, inner).fail(why_unknown(inner, schema_.keys()));
    }
  }
}

void DocumentReader::read_record(const YamlEntry& entry, const std::string& path) {
  if (extends_ && entry.value.is_scalar()) return read_bare(entry, path);
  const Place record = place(entry, path);
  const std::vector<std::size_t> indices = schema_.record(path);
  if (!entry.value.is_mapping())
    record.fail(fmt::format("is {}; expected a map {{ {}: …, unit: …, source: …, confidence: … }}",
                            kind_of(entry.value), schema_.fields()[indices.front()].name));
  const std::vector<YamlEntry> entries = entries_of(entry.value, file_, path);
  check_keys(entries, path);
  const Provenance provenance = read_provenance(entries, path, record);
  bool any = false;
  for (const std::size_t index : indices) {
    document_.settings[index].reset();  // what the base says
    const Field& field = schema_.fields()[index];
    const bool given = find(entries, field.name) != nullptr;
    any = any || given;
    if (given)
      read_field(index, entries, provenance, entry.line);
    else if (field.required || find(entries, field.range_key()) != nullptr)
      record.fail(fmt::format("missing key '{}' ({})", field.name, field.description));
  }
  if (!any)
    record.fail(
        fmt::format("gives no value; expected '{}'", schema_.fields()[indices.front()].name));
}

/// "workers: 16", "clock: 300MHz": what if it were so. Only where another platform is changed.
void DocumentReader::read_bare(const YamlEntry& entry, const std::string& path) {
  const Place record = place(entry, path);
  const std::vector<std::size_t> indices = schema_.record(path);
  if (indices.size() > 1)
    record.fail(
        fmt::format("is a single value; expected a map {{ {}: …, unit: …, source: …, "
                    "confidence: … }}",
                    schema_.fields()[indices.front()].name));
  std::optional<Setting>& setting = document_.settings[indices.front()];
  setting = read_override(schema_.fields()[indices.front()], setting, scalar(entry.value, record),
                          record);
  setting->where = fmt::format("{}:{}", file_, entry.line);
  setting->parameter.source = kWhatIfKey;
  setting->parameter.confidence = "assumed";
  document_.sources.try_emplace(kWhatIfKey, kWhatIfMeaning);
}

/// Every key of a record must be a column, the range of one, or one of the general keys.
void DocumentReader::check_keys(const std::vector<YamlEntry>& entries,
                                const std::string& path) const {
  std::vector<std::string> known;
  bool has_unit = false;
  for (const std::size_t index : schema_.record(path)) {
    const Field& field = schema_.fields()[index];
    known.push_back(field.name);
    if (!field.is_choice()) known.push_back(field.range_key());
    has_unit = has_unit || !field.is_choice();
  }
  if (has_unit) known.push_back("unit");
  known.insert(known.end(), {"source", "confidence", "note"});
  for (const YamlEntry& entry : entries) {
    bool found = false;
    for (const std::string& key : known) found = found || key == entry.key;
    if (!found)
      place(entry, joined(path, entry.key))
          .fail(fmt::format("unknown key; expected {}{}", fmt::join(known, ", "),
                            base::did_you_mean(entry.key, known)));
  }
}

Provenance DocumentReader::read_provenance(const std::vector<YamlEntry>& entries,
                                           const std::string& path, const Place& record) const {
  static constexpr std::array<std::string_view, 4> kWords = {"high", "medium", "low", "assumed"};
  const auto text = [&](const std::string& key, bool required) -> std::string {
    const YamlEntry* entry = find(entries, key);
    if (entry == nullptr && required) record.fail(fmt::format("missing key '{}'", key));
    if (entry == nullptr) return {};
    const std::string value = scalar(entry->value, place(*entry, joined(path, key)));
    if (trim(value).empty()) place(*entry, joined(path, key)).fail("is empty");
    return value;
  };
  bool has_unit = false;
  for (const std::size_t index : schema_.record(path)) {
    const Field& field = schema_.fields()[index];
    has_unit = has_unit || (!field.is_choice() && find(entries, field.name) != nullptr);
  }
  const Provenance provenance{text("unit", has_unit), text("source", true),
                              text("confidence", true), text("note", false)};
  check_source(provenance.source, place(*find(entries, "source"), joined(path, "source")));
  bool known = false;
  for (const std::string_view word : kWords) known = known || word == provenance.confidence;
  if (!known) {
    const std::vector<std::string> words(kWords.begin(), kWords.end());
    place(*find(entries, "confidence"), joined(path, "confidence"))
        .fail(fmt::format("'{}' is not known; expected one of {}{}", provenance.confidence,
                          fmt::join(words, ", "),
                          base::did_you_mean(provenance.confidence, words)));
  }
  return provenance;
}

/// "SDK-1, RTL-2 (FACTS.md#floating-point-units)": what stands before the parenthesis must be
/// listed.
void DocumentReader::check_source(const std::string& source, const Place& place) const {
  std::string_view keys = std::string_view(source).substr(0, source.find('('));
  for (;;) {
    const std::size_t comma = keys.find(',');
    const std::string key(trim(keys.substr(0, comma)));
    if (document_.sources.count(key) == 0) {
      std::vector<std::string> known;
      for (const auto& [name, text] : document_.sources) known.push_back(name);
      place.fail(
          fmt::format("'{}' is not listed under sources{}", key, base::did_you_mean(key, known)));
    }
    if (comma == std::string_view::npos) return;
    keys.remove_prefix(comma + 1);
  }
}

void DocumentReader::read_field(std::size_t index, const std::vector<YamlEntry>& entries,
                                const Provenance& provenance, int line) {
  const Field& field = schema_.fields()[index];
  const YamlEntry& entry = *find(entries, field.name);
  const std::string path = joined(field.record, field.name);
  if (!field.is_choice())
    check_unit(field, provenance.unit, place(*find(entries, "unit"), joined(field.record, "unit")));
  const Place at = place(entry, path);
  Setting setting = read_value(field, scalar(entry.value, at), provenance.unit, at);
  setting.where = fmt::format("{}:{}", file_, line);
  setting.parameter.source = provenance.source;
  setting.parameter.confidence = provenance.confidence;
  setting.parameter.note = provenance.note;
  if (const YamlEntry* range = find(entries, field.range_key()))
    setting.parameter.range = read_range_of(field, *range, setting);
  document_.settings[index] = std::move(setting);
}

Range DocumentReader::read_range_of(const Field& field, const YamlEntry& entry,
                                    const Setting& value) const {
  const Place at = place(entry, joined(field.record, entry.key));
  const YamlNode& list = entry.value;
  if (!list.is_sequence() || list.size() != 2)
    at.fail("expected a list of two numbers, [low, high]");
  return read_range(field, value, scalar(list[0], at), scalar(list[1], at), at);
}

/// Every required parameter must have been given.
void DocumentReader::check_complete() const {
  for (std::size_t i = 0; i < schema_.fields().size(); ++i) {
    const Field& field = schema_.fields()[i];
    if (!field.required || document_.settings[i]) continue;
    std::string section = field.record;
    int line = 1;
    while (line == 1 && section.find('.') != std::string::npos) {
      section = section.substr(0, section.rfind('.'));
      if (const auto found = section_lines_.find(section); found != section_lines_.end())
        line = found->second;
    }
    place_of(file_, line, field.record).fail(fmt::format("missing key ({})", field.description));
  }
}

}  // namespace

Document read_document(const Schema& schema, const std::string& file, const std::string& text,
                       const std::optional<BaseOverride>& base) {
  return DocumentReader(schema, file).read_platform(text, base);
}

}  // namespace leviosim::platform
