#include "platform_models/loader/schema.h"

#include <system_error>

#include "platform_models/loader/fields.h"
#include "sim/base/check.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {

Schema::Schema() : fields_(all_fields()) {
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    check(by_path_.emplace(field.path, i).second, "a parameter is described twice");
    by_record_[field.record].push_back(i);
    for (std::size_t dot = field.record.find('.'); dot != std::string::npos;
         dot = field.record.find('.', dot + 1))
      sections_.insert(field.record.substr(0, dot));
  }
}

std::size_t Schema::find(std::string_view path) const {
  const auto found = by_path_.find(path);
  return found == by_path_.end() ? kNone : found->second;
}

bool Schema::is_section(std::string_view path) const { return sections_.count(path) > 0; }

std::vector<std::size_t> Schema::record(std::string_view path) const {
  const auto found = by_record_.find(path);
  return found == by_record_.end() ? std::vector<std::size_t>{} : found->second;
}

std::vector<std::string> Schema::paths() const {
  std::vector<std::string> paths;
  for (const Field& field : fields_) paths.push_back(field.path);
  return paths;
}

std::vector<std::string> Schema::keys() const {
  std::vector<std::string> keys(sections_.begin(), sections_.end());
  for (const auto& [record, fields] : by_record_) keys.push_back(record);
  return keys;
}

std::string why_unknown(const std::string& path, const std::vector<std::string>& known) {
  if (path.ends_with(".instruction_overhead"))
    return "no such key any more: compiled code is taken as it was measured; delete it";
  return "unknown key" + base::did_you_mean(path, known);
}

}  // namespace leviosim::platform
