// The lines of code that a core executes, from the events of its functions and the sizes of their
// compiled pieces: what the tracker sums up (sim/work/code_tracker.h), one line after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "sim/work/code_events.h"
#include "sim/work/code_map.h"
#include "tests/support/line_caches.h"

namespace leviosim::tests {

/// Where each piece lies: functions one behind the other, in an order by chance; the pieces of a
/// function together.
class CodeLayout {
 public:
  static constexpr double kLine = 16;

  CodeLayout(const work::CodeMap& map, std::uint64_t seed)
      : map_(&map), first_(map.pieces().size()) {
    std::map<std::uint64_t, std::vector<std::size_t>> functions;
    for (std::size_t i = 0; i < map.pieces().size(); ++i)
      functions[map.pieces()[i].key >> 32].push_back(i);
    std::vector<const std::vector<std::size_t>*> order;
    for (const auto& [name, pieces] : functions) order.push_back(&pieces);
    RandomNumbers random(seed);
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    for (const auto* pieces : order)
      for (const std::size_t piece : *pieces) {
        first_[piece] = end_;
        end_ += static_cast<std::uint32_t>(std::ceil(map.pieces()[piece].bytes / kLine));
      }
  }

  const work::CodeMap& map() const { return *map_; }
  std::uint32_t first_line(std::size_t piece) const { return first_[piece]; }

 private:
  const work::CodeMap* map_;
  std::vector<std::uint32_t> first_;
  std::uint32_t end_ = 0;
};

/// Walks through events. Sizes are means over visits: a piece of 3.5 lines is walked through with 3
/// and 4 of them in turns.
class CodeWalk {
 public:
  explicit CodeWalk(const CodeLayout& layout)
      : layout_(layout), carried_(layout.map().pieces().size()) {}

  void follow(const std::vector<work::CodeEvent>& events) {
    for (const work::CodeEvent event : events) follow(event);
  }
  const LineList& lines() const { return lines_; }
  /// What has come since the last call.
  LineList take() { return std::exchange(lines_, {}); }

 private:
  struct Rest {
    double of_visit = 0;
    double of_repetition = 0;
  };

  void follow(work::CodeEvent event) {
    using work::CodeMap;
    if (event == work::CodeEvents::kLeave) {
      if (callers_.empty()) return;
      const std::uint32_t returned = callers_.back();
      callers_.pop_back();
      if (!callers_.empty()) visit(CodeMap::piece_key(callers_.back(), returned));
    } else if (event < work::CodeName::kSmallest) {
      work::CodeEvents::for_each_routine(event, [&](work::Routine routine) {
        visit(CodeMap::piece_key(work::name_of(routine).key, CodeMap::kEntry));
      });
    } else {
      callers_.push_back(event);
      visit(CodeMap::piece_key(event, CodeMap::kEntry));
    }
  }

  void visit(std::uint64_t key) {
    const int found = layout_.map().find(key);
    if (found == work::CodeMap::kUnknown) return;
    const auto piece = static_cast<std::size_t>(found);
    const work::CodeMap::Piece& code = layout_.map().pieces()[piece];
    Rest& rest = carried_[piece];
    const int lines = whole(code.bytes, rest.of_visit);
    const int again = whole(code.again_bytes, rest.of_repetition);
    for (int i = 0; i < lines; ++i) lines_.push_back(layout_.first_line(piece) + i);
    for (int i = 0; lines > 0 && i < again; ++i)
      lines_.push_back(layout_.first_line(piece) + i % lines);
  }

  static int whole(std::uint32_t bytes, double& rest) {
    rest += bytes / CodeLayout::kLine;
    const double lines = std::floor(rest + 1e-9);
    rest -= lines;
    return static_cast<int>(lines);
  }

  const CodeLayout& layout_;
  std::vector<Rest> carried_;
  std::vector<std::uint32_t> callers_;
  LineList lines_;
};

}  // namespace leviosim::tests
