#include "sim/base/yaml_document.h"

#include <fmt/core.h>
#include <yaml.h>

#include <algorithm>
#include <map>
#include <new>
#include <utility>

#include "sim/base/check.h"

namespace leviosim::base {
namespace {

constexpr std::string_view kOwnTags = "tag:yaml.org,2002:";

struct Event : yaml_event_t {
  Event() : yaml_event_t{} {}
  ~Event() { yaml_event_delete(this); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  int line() const { return static_cast<int>(start_mark.line) + 1; }
};

std::string_view text_of(const yaml_char_t* text) {
  return text == nullptr ? std::string_view() : reinterpret_cast<const char*>(text);
}

/// libyaml, which gives one event after the other and needs no recursion.
class EventReader {
 public:
  explicit EventReader(std::string_view text) : text_(text) {
    if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
    yaml_parser_set_encoding(&parser_, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
  }
  ~EventReader() { yaml_parser_delete(&parser_); }
  EventReader(const EventReader&) = delete;
  EventReader& operator=(const EventReader&) = delete;

  void next(Event& event) {
    if (yaml_parser_parse(&parser_, &event) == 0) fail();
  }

 private:
  [[noreturn]] void fail() const {
    if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
    const char* const problem = parser_.problem == nullptr ? "a fault" : parser_.problem;
    // Faults of the encoding have a place in the bytes only.
    if (parser_.error == YAML_READER_ERROR) {
      const std::string_view before =
          text_.substr(0, std::min(parser_.problem_offset, text_.size()));
      const auto line = std::count(before.begin(), before.end(), '\n') + 1;
      throw YamlFault(static_cast<int>(line), "", fmt::format("not valid YAML: {}", problem));
    }
    const std::string context =
        parser_.context == nullptr ? std::string() : fmt::format(" {}", parser_.context);
    throw YamlFault(static_cast<int>(parser_.problem_mark.line) + 1, "",
                    fmt::format("not valid YAML: {}{}, column {}", problem, context,
                                parser_.problem_mark.column + 1));
  }

  std::string_view text_;
  yaml_parser_t parser_{};
};

bool means_nothing(std::string_view text) {
  return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
}

}  // namespace

/// Turns events into the tree. What is open is kept on a stack of its own.
class YamlTreeBuilder {
 public:
  YamlNode build(std::string_view text) {
    EventReader reader(text);
    for (bool goes_on = true; goes_on;) {
      Event event;
      reader.next(event);
      goes_on = take(event);
    }
    if (tree_.empty()) throw YamlFault(1, "", "the file is empty");
    return YamlNode(std::make_shared<const YamlNode::Tree>(std::move(tree_)), 0);
  }

 private:
  using Kind = YamlNode::Kind;

  /// A mapping or sequence whose end has not come.
  struct Open {
    std::uint32_t index;
    bool is_mapping;
    std::map<std::string, int> first_lines;  // of its keys
    YamlNode::Key key;                       // the last one
    bool has_key;                            // whose value comes next
  };

  bool take(const Event& event) {
    switch (event.type) {
      case YAML_DOCUMENT_START_EVENT:
        if (!tree_.empty()) fail(event, "a second document begins; expected one");
        return true;
      case YAML_SCALAR_EVENT:
        take_scalar(event);
        return true;
      case YAML_SEQUENCE_START_EVENT:
        open(event, Kind::sequence, event.data.sequence_start.anchor,
             event.data.sequence_start.tag);
        return true;
      case YAML_MAPPING_START_EVENT:
        open(event, Kind::mapping, event.data.mapping_start.anchor, event.data.mapping_start.tag);
        return true;
      case YAML_SEQUENCE_END_EVENT:
      case YAML_MAPPING_END_EVENT:
        open_.pop_back();
        return true;
      case YAML_ALIAS_EVENT:
        refuse_alias(event);
      default:
        return event.type != YAML_STREAM_END_EVENT;
    }
  }

  void take_scalar(const Event& event) {
    const auto& scalar = event.data.scalar;
    const std::string_view text(reinterpret_cast<const char*>(scalar.value), scalar.length);
    const bool plain = scalar.style == YAML_PLAIN_SCALAR_STYLE && scalar.tag == nullptr;
    const Kind kind = plain && means_nothing(text) ? Kind::null : Kind::scalar;
    if (expects_key()) {
      if (kind == Kind::null) fail(event, "a key is empty; expected a word");
      check_properties(event, kind, scalar.anchor, scalar.tag);
      take_key(event, std::string(text));
      return;
    }
    const std::uint32_t index = add(event, kind, scalar.anchor, scalar.tag);
    if (kind == Kind::scalar) tree_[index].text = text;
  }

  void open(const Event& event, Kind kind, const yaml_char_t* anchor, const yaml_char_t* tag) {
    const bool is_mapping = kind == Kind::mapping;
    if (expects_key())
      fail(event, fmt::format("a key is {}; expected a word", is_mapping ? "a map" : "a list"));
    if (open_.size() == kMostYamlDepth)
      fail(event, fmt::format("is nested deeper than {} levels", kMostYamlDepth));
    open_.push_back({add(event, kind, anchor, tag), is_mapping, {}, {}, false});
  }

  bool expects_key() const {
    return !open_.empty() && open_.back().is_mapping && !open_.back().has_key;
  }

  void take_key(const Event& event, std::string key) {
    Open& mapping = open_.back();
    const auto [first, is_new] = mapping.first_lines.emplace(key, event.line());
    mapping.key = {std::move(key), event.line()};
    mapping.has_key = true;
    if (!is_new) fail(event, fmt::format("duplicate key, first given on line {}", first->second));
  }

  /// Hangs a new node into what is open.
  std::uint32_t add(const Event& event, Kind kind, const yaml_char_t* anchor,
                    const yaml_char_t* tag) {
    check_properties(event, kind, anchor, tag);
    if (tree_.size() == kMostYamlNodes)
      fail(event, fmt::format("the file holds more than {} values", kMostYamlNodes));
    const auto index = static_cast<std::uint32_t>(tree_.size());
    if (!open_.empty()) {
      Open& parent = open_.back();
      YamlNode::Item& item = tree_[parent.index];
      if (parent.is_mapping) item.keys.push_back(parent.key);
      item.values.push_back(index);
      parent.has_key = false;
    }
    YamlNode::Item& item = tree_.emplace_back();
    item.kind = kind;
    item.line = event.line();
    return index;
  }

  void check_properties(const Event& event, Kind kind, const yaml_char_t* anchor,
                        const yaml_char_t* tag) const {
    if (anchor != nullptr) refuse_alias(event);
    std::string_view name = text_of(tag);
    if (name.empty() || name == "!") return;
    const bool own = name.substr(0, kOwnTags.size()) == kOwnTags;
    if (own) name.remove_prefix(kOwnTags.size());
    const bool fits =
        kind == Kind::mapping ? name == "map"
        : kind == Kind::sequence
            ? name == "seq"
            : name == "str" || name == "int" || name == "float" || name == "bool" || name == "null";
    if (!own || !fits) fail(event, "has a tag that is not known here; expected none");
  }

  [[noreturn]] void refuse_alias(const Event& event) const {
    fail(event, "anchors (&) and aliases (*) are not known here; expected the value itself");
  }

  [[noreturn]] void fail(const Event& event, const std::string& message) const {
    std::string path;
    for (const Open& open : open_) {
      const bool is_within = &open != &open_.back() || open.has_key;
      if (open.is_mapping && is_within) path += (path.empty() ? "" : ".") + open.key.text;
    }
    throw YamlFault(event.line(), path, message);
  }

  YamlNode::Tree tree_;
  std::vector<Open> open_;
};

YamlNode parse_yaml(std::string_view text) {
  if (text.size() > kMostYamlBytes)
    throw YamlFault(1, "", fmt::format("is larger than {} bytes", kMostYamlBytes));
  return YamlTreeBuilder().build(text);
}

}  // namespace leviosim::base
