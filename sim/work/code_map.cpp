#include "sim/work/code_map.h"

#include <fmt/format.h>

#include <bit>

#include "sim/base/check.h"

namespace leviosim::work {

void CodeMap::add(std::string_view function, std::string_view after, std::uint32_t bytes,
                  std::uint32_t again_bytes, const CompiledSets& compiled) {
  const std::uint32_t then = after.empty() ? kEntry : CodeName(after).key;
  const std::uint64_t key = piece_key(CodeName(function).key, then);
  check(find(key) == kUnknown,
        fmt::format("piece of code \"{}\" after \"{}\" is there already", function, after));
  pieces_.push_back({key, bytes, again_bytes, compiled});
  rebuild_table();
}

void CodeMap::rebuild_table() {
  table_.assign(std::bit_ceil(4 * pieces_.size()), kUnknown);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    std::size_t slot = slot_of(pieces_[i].key);
    while (table_[slot] != kUnknown) slot = (slot + 1) & (table_.size() - 1);
    table_[slot] = static_cast<int>(i);
  }
}

}  // namespace leviosim::work
