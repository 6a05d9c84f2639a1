// Whether a text is well-formed XML, as far as leviosim's pictures use it: one root, nested tags,
// quoted attributes that are named once, escaped text. (No CDATA, no DOCTYPE.)
#pragma once

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools::testing {

class XmlCheck {
 public:
  explicit XmlCheck(std::string_view text) : text_(text) {}

  /// Empty if it is well-formed, else what is wrong.
  std::string fault() {
    if (!text_.starts_with("<?xml ")) return "no declaration";
    text_.remove_prefix(text_.find("?>") + 2);
    while (!text_.empty() && fault_.empty()) text_.front() == '<' ? tag() : words();
    if (fault_.empty() && !open_.empty()) return "not closed: " + open_.back();
    if (fault_.empty() && roots_ != 1) return "not one root";
    return fault_;
  }

 private:
  void words() {
    const std::string_view run = text_.substr(0, text_.find('<'));
    text_.remove_prefix(run.size());
    if (open_.empty() && run.find_first_not_of(" \n") != run.npos) fault_ = "text outside the root";
    check_text(run);
  }
  void tag() {
    const auto end = text_.find('>');
    if (end == text_.npos) return void(fault_ = "a tag without end");
    std::string_view inside = text_.substr(1, end - 1);
    text_.remove_prefix(end + 1);
    if (inside.starts_with('/')) return close(inside.substr(1));
    const bool empty = inside.ends_with('/');
    if (empty) inside.remove_suffix(1);
    const std::string name(inside.substr(0, inside.find(' ')));
    inside.remove_prefix(name.size());
    if (open_.empty()) ++roots_;
    attributes(inside);
    if (!empty) open_.push_back(name);
  }
  void close(std::string_view name) {
    if (open_.empty() || open_.back() != name) return void(fault_ = "closes " + std::string(name));
    open_.pop_back();
  }
  void attributes(std::string_view rest) {
    std::set<std::string_view> names;
    while (fault_.empty() && !rest.empty()) {
      const auto equals = rest.find("=\"");
      const auto quote = equals == rest.npos ? rest.npos : rest.find('"', equals + 2);
      if (rest.front() != ' ' || quote == rest.npos)
        return void(fault_ = "attribute: " + std::string(rest));
      if (!names.insert(rest.substr(1, equals - 1)).second) fault_ = "an attribute twice";
      check_text(rest.substr(equals + 2, quote - equals - 2));
      rest.remove_prefix(quote + 1);
    }
  }
  void check_text(std::string_view text) {
    for (const char c : text)
      if (static_cast<unsigned char>(c) < 0x20u && c != '\n' && c != '\t')
        fault_ = "a control character";
    for (auto at = text.find('&'); at != text.npos; at = text.find('&', at + 1)) {
      const std::string_view entity = text.substr(at, text.find(';', at) - at + 1);
      const std::set<std::string_view> known{"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
      if (known.count(entity) == 0) fault_ = "entity: " + std::string(entity);
    }
  }

  std::string_view text_;
  std::vector<std::string> open_;
  int roots_ = 0;
  std::string fault_;
};

}  // namespace leviosim::tools::testing
