// Follows one core through the code it executes (code_events.h) and counts what it fetches by reuse
// distance (code_reuse.h), from the sizes of the compiled pieces of functions (code_map.h).
//
// Programs go round in loops, so the same events come again and again while the core has last
// fetched the same pieces in the same order. That order, with the functions entered, is therefore a
// *state*, and what a window of events fetches is remembered with its step from state to state, as
// lazily built automata of regular expressions do. The states are a memory only: without them the
// same bytes are counted, at many times the cost.
//
// Left out: code outside of named functions, and the order of fetches within a piece. Small loops
// are fetched once per visit; what larger ones fetch again is part of the map.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "sim/work/code_events.h"
#include "sim/work/code_map.h"

namespace leviosim::work {

class CodeTracker {
 public:
  /// @param map  outlives the tracker
  explicit CodeTracker(const CodeMap& map) : map_(&map) { start_from({}); }

  /// Adds to the tally of this thread what these events fetch.
  void follow(std::span<const CodeEvent> events);

 private:
  static constexpr std::int32_t kNone = -1;
  /// States kept at most; then all are forgotten but the present one.
  static constexpr std::size_t kMostStates = 1 << 14;

  struct Place {
    std::vector<std::uint32_t> order;    ///< pieces by index, the one visited last first
    std::vector<std::uint32_t> callers;  ///< functions entered and not left, by hash
    bool operator==(const Place&) const = default;
  };
  struct State {
    std::int32_t first_step = kNone;
    Place place;
  };
  struct Range {
    std::uint32_t begin, end;
  };
  struct Step {
    std::uint64_t hash;    ///< of the events
    std::int32_t sibling;  ///< another step out of the same state
    std::uint32_t next_state;
    Range events, fetches;
  };
  struct Fetch {
    std::uint32_t reuse;  ///< class of the distance
    std::uint32_t bytes;
  };

  std::int32_t find_step(std::uint64_t hash, std::span<const CodeEvent> events);
  std::int32_t add_step(std::uint64_t hash, std::span<const CodeEvent> events);
  void walk(Place& place, CodeEvent event);
  /// Appends to fetches_ what visiting the piece fetches, and moves it to the front.
  void visit(Place& place, std::uint64_t piece_key);
  /// Makes one of the fetches of the same class from `first` on.
  void merge_fetches(std::size_t first);
  std::uint32_t state_of(const Place& place);
  void start_from(Place place);

  const CodeMap* map_;
  std::uint32_t state_ = 0;
  std::vector<State> states_;
  std::vector<Step> steps_;
  std::vector<CodeEvent> events_;  ///< of all steps
  std::vector<Fetch> fetches_;     ///< of all steps
  std::unordered_multimap<std::uint64_t, std::uint32_t> state_of_hash_;
};

/// The core that the host thread executes at the moment, or none. Thread-local like the tally, and
/// for the same reason.
inline constinit thread_local CodeTracker* current_code = nullptr;

/// Brings the tally up to date with the events of the present core, before it is read or another
/// core goes on.
void fetch_code();

}  // namespace leviosim::work
