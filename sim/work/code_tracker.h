// Follows one core through the code it executes and counts what it fetches by reuse distance
// (code_reuse.h), from the entries and returns of named functions and the sizes of their compiled
// pieces (code_map.h).
//
// Left out: code outside of named functions, and the order of fetches within a piece. Small loops
// are fetched once per visit; what larger ones fetch again is part of the map.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/work/code_map.h"
#include "sim/work/counts.h"

namespace leviosim::work {

class CodeTracker {
 public:
  /// @param map  outlives the tracker
  explicit CodeTracker(const CodeMap& map) : map_(&map) {}

  void enter(std::uint32_t function) {
    callers_.push_back(function);
    visit(CodeMap::piece_key(function, CodeMap::kEntry));
  }
  void leave() {
    const std::uint32_t returned = callers_.back();
    callers_.pop_back();
    if (!callers_.empty()) visit(CodeMap::piece_key(callers_.back(), returned));
  }
  /// A library routine: fetched without cutting the code of its caller into pieces.
  void call_routine(std::uint32_t function) {
    visit(CodeMap::piece_key(function, CodeMap::kEntry));
  }

 private:
  struct Visited {
    int piece;
    std::uint32_t bytes;
  };

  void visit(std::uint64_t key);

  const CodeMap* map_;
  std::vector<std::uint32_t> callers_;
  std::vector<Visited> recent_;  ///< pieces visited so far, the latest first
};

/// The core that the host thread executes at the moment, or none. Thread-local like the tally, and
/// for the same reason.
inline constinit thread_local CodeTracker* current_code = nullptr;

}  // namespace leviosim::work
