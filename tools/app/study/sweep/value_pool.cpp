#include "tools/app/study/sweep/value_pool.h"

namespace leviosim::tools {

ValuePool::ValuePool(std::size_t keys) {
  for (std::size_t key = 0; key < keys; ++key) tables_.emplace_back();
}

ValueId ValuePool::add(std::size_t key, const std::string& text) {
  Table& table = tables_[key];
  const auto known = table.ids.find(std::string_view(text));
  if (known != table.ids.end()) return *known;
  const auto id = static_cast<ValueId>(table.texts.size());
  table.texts.push_back(text);
  table.ids.insert(id);
  return id;
}

}  // namespace leviosim::tools
