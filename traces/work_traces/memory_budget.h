// How much of the host's memory reading a file may take: a ledger with a ceiling. Readers enter
// what they are about to allocate, so a small file that stands for much is refused before it is
// given the memory, not when the host has none left.
//
// An entry is what the values take and what is derived from them later (a timing, a row of a
// report), so it is higher than the size of the values alone. Left out: what the allocator adds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/base/units.h"

namespace leviosim::traces {

class MemoryBudget {
 public:
  explicit MemoryBudget(Bytes ceiling) : ceiling_(static_cast<std::uint64_t>(ceiling.count())) {}

  /// Enters so many bytes. False, and nothing entered, if that is more than is left.
  [[nodiscard]] bool take(std::uint64_t bytes) {
    if (bytes > ceiling_ - used_) [[unlikely]]
      return false;
    used_ += bytes;
    return true;
  }
  /// Strikes out the entries since used() was that.
  void release_to(std::uint64_t used) { used_ = used; }

  std::uint64_t used() const { return used_; }
  std::uint64_t ceiling() const { return ceiling_; }

  /// Why take(bytes) fails. @param what  is to be read, e.g. "4000000 steps of a stage"
  std::string refusal(std::string_view what, std::uint64_t bytes) const;

 private:
  std::uint64_t ceiling_;
  std::uint64_t used_ = 0;
};

/// "64 MiB", in the largest binary unit below the number.
std::string memory_text(std::uint64_t bytes);

}  // namespace leviosim::traces
