// Follows the cores of a machine through the code they execute (code_events.h), one at a time, and
// counts what each fetches by reuse distance (code_reuse.h), from the sizes of the compiled pieces
// of functions (code_map.h), and what the functions entered execute (compiled_work.h).
//
// Programs go round in loops, so the same events come again and again while the core has last
// fetched the same pieces in the same order. That order, with the functions entered, is therefore a
// *state*, and what a window of events fetches is remembered with its step from state to state, as
// lazily built automata of regular expressions do. The states are a memory only: without them the
// same bytes are counted, at many times the cost. Windows are identified by a hash of 64 bits.
// Cores execute the same program, so they share the states.
//
// Left out: code outside of named functions, and the order of fetches within a piece. Small loops
// are fetched once per visit; what larger ones fetch again is part of the map.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "sim/work/code_events.h"
#include "sim/work/code_map.h"
#include "sim/work/compiled_work.h"

namespace leviosim::work {

class CodeTracker {
 public:
  /// @param map  outlives the tracker
  explicit CodeTracker(const CodeMap& map, int cores = 1)
      : map_(&map), states_of_cores_(static_cast<std::size_t>(cores), state_of({})) {}

  /// The events that follow are those of this core.
  void select(int core);
  void follow(const CodeWindow& window);
  /// Adds to the tally of this thread what the events since the last call fetched.
  void settle();

  /// From now on, appends the events of each core to its list, for who wants to walk through the
  /// code line by line: those of a work segment together. The lists are as many as the cores.
  using EventsOfSegments = std::vector<std::vector<CodeEvent>>;
  void keep_events(std::vector<EventsOfSegments>* events) { kept_ = events; }

  /// What was executed and is not in the map, and so counts as code of no size: keys of pieces
  /// (CodeMap::piece_key).
  const std::set<std::uint64_t>& without_size() const { return without_size_; }

 private:
  static constexpr std::int32_t kNone = -1;
  /// Kept at most, of a flight of any length; then all are forgotten but the present ones.
  static constexpr std::size_t kMostStates = 1 << 12;

  struct Place {
    std::vector<std::uint32_t> order;    ///< pieces by index, the one visited last first
    std::vector<std::uint32_t> callers;  ///< functions entered and not left, by hash
    bool operator==(const Place&) const = default;
  };
  struct Range {
    std::uint32_t begin, end;
  };
  struct Step {
    std::uint64_t window;  ///< hash of its events
    Range fetches;
    std::uint32_t next_state;
    std::int32_t sibling;    ///< another step out of the same state
    CompiledSets compiled;   ///< of the functions entered
    std::uint32_t uses = 0;  ///< not settled yet
  };
  struct Fetch {
    std::uint32_t reuse;  ///< class of the distance
    std::uint32_t bytes;
  };

  /// Among those that are not the latest, or a new one.
  std::int32_t find_step(const CodeWindow& window);
  std::int32_t add_step(const CodeWindow& window);
  void walk(Place& place, CodeEvent event);
  /// Appends to fetches_ what visiting the piece fetches, and moves it to the front.
  void visit(Place& place, std::uint64_t piece_key);
  /// Makes one of the fetches of the same class from `first` on.
  void merge_fetches(std::size_t first);
  std::uint32_t state_of(const Place& place);
  /// Settles and forgets all states but those in which the cores are.
  void forget();

  const CodeMap* map_;
  std::vector<Place> places_;              ///< of all states
  std::vector<std::int32_t> first_steps_;  ///< out of all states, the latest first
  std::vector<Step> steps_;
  std::vector<Fetch> fetches_;           ///< of all steps
  std::vector<std::int32_t> unsettled_;  ///< steps in use
  std::unordered_multimap<std::uint64_t, std::uint32_t> state_of_hash_;
  CompiledSets entered_{};  ///< of the step that is being added
  std::set<std::uint64_t> without_size_;
  std::vector<EventsOfSegments>* kept_ = nullptr;
  std::size_t core_ = 0;                        ///< the one selected
  std::uint32_t state_ = 0;                     ///< of that core
  std::vector<std::uint32_t> states_of_cores_;  ///< of the other cores
};

/// Of the machine whose code the host thread executes at the moment, or none. Thread-local like the
/// tally, and for the same reason.
inline constinit thread_local CodeTracker* current_code = nullptr;

/// Brings the tally up to date with the events of the present core, before it is read or another
/// core goes on.
void fetch_code();

}  // namespace leviosim::work
