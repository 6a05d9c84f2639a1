// Which 16-byte lines a stretch of code fetches, and how often it would fetch one again that a
// 512-byte cache has lost: fully associative, least recently used out first, empty at the begin.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace leviosim::rv32 {

inline constexpr std::uint32_t kLineBytes = 16;
inline constexpr std::size_t kCacheLines = 512 / kLineBytes;

/// A set of lines.
class LineSet {
 public:
  void add(std::uint32_t line) {
    if (line >= there_.size()) there_.resize(line + 1024);
    count_ += there_[line] == 0;
    there_[line] = 1;
  }
  int count() const { return count_; }

 private:
  std::vector<std::uint8_t> there_;
  int count_ = 0;
};

class Footprint {
 public:
  void start() {
    ++visit_;
    distinct_ = misses_ = 0;
    filled_ = 0;
    last_ = ~0u;
  }
  void touch(std::uint32_t line) {
    if (line == last_) return;
    last_ = line;
    if (line >= seen_in_.size()) seen_in_.resize(line + 1024);
    if (seen_in_[line] != visit_) {
      seen_in_[line] = visit_;
      ++distinct_;
    }
    const auto end = cache_.begin() + static_cast<long>(filled_);
    auto it = std::find(cache_.begin(), end, line);
    if (it == end) {
      ++misses_;
      if (filled_ < kCacheLines) ++filled_;
      it = cache_.begin() + static_cast<long>(filled_) - 1;
    }
    std::move_backward(cache_.begin(), it, it + 1);
    cache_[0] = line;
  }
  int distinct() const { return distinct_; }
  int refetches() const { return misses_ - distinct_; }

 private:
  std::vector<std::uint32_t> seen_in_;
  std::uint32_t visit_ = 0;
  int distinct_ = 0, misses_ = 0;
  std::array<std::uint32_t, kCacheLines> cache_{};
  std::size_t filled_ = 0;
  std::uint32_t last_ = ~0u;
};

}  // namespace leviosim::rv32
