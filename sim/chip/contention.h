// How fast cores progress while they share units: a fluid model, solved anew whenever the set of
// running segments changes.
//
// A core's rate is the share of each cycle in which it progresses as if it were alone: 1 without
// contention. A shared unit serves requests in turn (round robin by request,
// FACTS.md#calibration-table: four cores dividing in single and four in half precision take 4·14 +
// 4·10 cycles a round), so when its demand exceeds its capacity, the requesters that are held back
// get equal request rates and the others all they ask for. How long a request occupies its unit is
// the mean over the operations of the segment that use this kind of unit. Refills of the shared
// instruction cache are served so, too.
//
// All accesses of L1 together are no more than its banks serve, one per cycle each. Below that,
// banks add a small delay to each access: with requesters j making p_j accesses per cycle
// on B interleaved banks, an access waits Σ p_j / (2B) cycles (FACTS.md#l1-memory). That is how
// code waits for the shared instruction cache, and scattered accesses for L1. Streams walk from
// bank to bank all at the same pace: one that meets another waits once and is out of its way for
// good. That holds for one stream per core; loops over several streams, rows of an operand that all
// cores read, and beginnings of loops make streams meet again and again. How often, compared with
// scattered accesses, is a number of the platform (FACTS.md#l1-memory).
//
// A floating-point or 64-bit integer unit that is not saturated makes nobody wait whose operations
// alternate with other instructions: cores that share it find their turns. Operations in a row do
// not, and whether two cores collide depends on their phase. What cores lose on average over phases
// has closed forms: for operations in runs, as loops have them that load their operands first
// (collisions_in_runs), and in any order (collisions_by_chance).
//
// A divider or an accelerator that is not saturated has a queue: a request waits for the rest of
// the one that is served, and for those that wait already (queued_behind). Cores do not keep out of
// each other's way, since what each does between its requests differs.
//
// Left out: transients of a few cycles until requesters have interleaved; chance collisions at
// words that all cores use, and at floating-point units of which any core may take any.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/cost.h"

namespace leviosim::sim {

/// What slows a core down while it runs beside others, per cycle of its running time.
struct Progress {
  double rate = 1;  ///< cycles of lone progress per cycle
  CoreCycles lost;  ///< shares of the time lost to shared units
};

/// One running segment as the solver sees it.
struct Runner {
  int core = 0;                              ///< id, decides the unit under a fixed mapping
  std::array<UnitDemand, kUnitCount> units;  ///< per lone cycle
  std::uint32_t asks = ~0u;                  ///< has a bit for each unit that is asked
  double streamed = 0;                       ///< L1 accesses by streams per lone cycle
  double scattered = 0;                      ///< other L1 accesses per lone cycle
  double fetches = 0;  ///< lines from the shared instruction cache per lone cycle

  static Runner of(int core, const Demand& demand);
};

/// What a core loses per lone cycle to another that shares a unit with it, if each instruction asks
/// for the unit with a probability of its own. Of two requests that meet, the one waits whose core
/// was served last: with probability mine / (mine + other). While it waits, the other core executes
/// its next instruction and may have to wait in turn. This is the solution of that Markov chain.
/// Two that ask in every cycle lose one cycle each.
constexpr double collisions_by_chance(double mine, double other) {
  const double both = mine * other;
  return both == 0 ? 0
                   : mine * both * (1 + other) /
                         ((1 - both) * (mine + other) + other * both * (1 + mine));
}

/// The same if both execute a share of their instructions in runs, at any phase. Of two loops of L
/// instructions that end with r operations each, the one d instructions ahead of the other, both
/// lose r - d cycles a round if 0 < d < r, and r - 1 if d = 0: (r² - 1) / L² over all phases.
/// Single operations find their turns.
constexpr double collisions_in_runs(double mine, double my_run, double other, double other_run) {
  return mine * other * (1 - 1 / (my_run * other_run));
}

/// Requests of one core to a unit that serves one after the other.
struct Queued {
  double rate = 0;     ///< per cycle
  double busy = 0;     ///< cycles of service
  double waiting = 0;  ///< cycles before
};

/// Cycles that a request waits behind those of another core, which it finds waiting or served, and
/// then in the middle of the service on average.
constexpr double queued_behind(const Queued& other) {
  const double there = other.rate * (other.busy + other.waiting);
  const double served = other.rate * other.busy;
  return ((there < 1 ? there : 1) - served / 2) * other.busy;
}

/// Requests of one runner to a unit: per lone cycle, and per cycle at its present rate.
struct UnitRequest {
  std::size_t runner;
  double per_lone_cycle;
  double per_cycle;
  double busy;  ///< cycles that one of them occupies the unit, on average
};

/// Solves the rates of all runners at once. Results are in the order of the runners, depend on
/// nothing but the runners and the DMA, and are within 1e-8 of the fixed point of the equations
/// above.
///
/// What is unknown is each runner's *pace*: its rate but for what it loses by chance. From paces
/// follow collisions, from these rates, from these queues (in closed form), waits and the next
/// paces. Each round after the second starts where a secant of the two before has its zero.
///
/// Units that cannot serve all make limits, which have corners. Rounds then go on from the rates of
/// the one before, with half of what queues change, until rates no longer change: those that limits
/// hold back settle at once, however long their queues still become.
class Contention {
 public:
  explicit Contention(const ClusterConfig& config);

  /// @param dma_words  words per cycle that the DMA moves in L1
  void solve(const std::vector<Runner>& runners, std::vector<Progress>& progress,
             double dma_words = 0);
  /// Rounds of all solutions so far.
  std::int64_t rounds() const { return rounds_; }

 private:
  /// Units of one kind: `pools` groups of `capacity` units; core c uses group c mod pools.
  struct Pools {
    int pools = 0;
    double capacity = 0;
    std::vector<int> pool_of{};  ///< of the runners, if there are several
  };
  /// Two runners that share a unit at which they collide by chance.
  struct Pair {
    std::size_t a, b;
    double of_a, of_b;  ///< cycles of the unit that they ask for per lone cycle
    double in_runs;     ///< of operations in runs: what collisions_in_runs() has of both…
    bool by_chance;     ///< … or whether they come in any order
  };
  /// A queue in front of a unit, and who stands in it.
  struct Queue {
    Unit unit;
    double units;
    struct Member {
      std::size_t runner;
      double requests;     ///< per lone cycle
      double busy;         ///< cycles that one occupies the unit
      double waiting = 0;  ///< cycles of one in the queue
      // What one waits behind those of this runner, by what it waits behind all (wait_in()).
      double constant = 0, slope = 0, most = 0;
    };
    std::vector<Member> members;
  };

  void begin(const std::vector<Runner>& runners, double dma_words);
  void find_pools(const std::vector<Runner>& runners);
  void pair_up(const std::vector<Runner>& runners, Unit unit);
  void find_scarce(const std::vector<Runner>& runners);
  /// One round: from paces to rates. Returns the largest change of a pace, or of a rate that has
  /// limits.
  double round(const std::vector<Runner>& runners);
  double settle();
  double settle_below_limits(const std::vector<Runner>& runners);
  void collide();
  void sum_up();
  /// What queued requests count of those before them: all if there is one unit.
  double counted_part(const Queue& queue) const;
  void wait_in(Queue& queue);
  void wait_some_more_in(Queue& queue);
  void limit(std::size_t unit, const std::vector<Runner>& runners);
  double allowed(std::size_t runner, std::size_t except) const;
  void secant_step(bool first);
  /// Cycles per lone cycle that a runner waits for L1 banks, and for those of the instruction
  /// cache.
  double l1_delay(std::size_t runner) const;
  double fetch_delay(std::size_t runner) const;
  void book_losses(std::vector<Progress>& progress) const;

  std::array<Pools, kUnitCount> pools_;
  std::vector<Unit> shared_;  ///< kinds of units that there are
  int banks_;
  double wait_for_bank_;       ///< of an access, for each one per cycle beside it
  double wait_for_code_bank_;  ///< of a fetch from the shared instruction cache
  double stream_conflicts_;
  double collisions_;
  std::int64_t rounds_ = 0;
  // Of the solution that is sought; vectors are by runner, and kept for their memory.
  double all_streamed_ = 0;  ///< per cycle at the present rates, by everybody
  double all_scattered_ = 0;
  double all_fetches_ = 0;
  double dma_words_ = 0;
  std::vector<double> streamed_, scattered_, fetches_;  ///< per lone cycle
  std::vector<Pair> pairs_;
  std::vector<Queue> queues_;
  std::uint32_t asked_ = 0;   ///< units that anybody asks for, as Runner::asks
  std::vector<Unit> scarce_;  ///< units that do not serve everybody at rate 1
  std::vector<double> pace_, next_pace_, change_;
  std::vector<double> last_next_pace_, last_change_;  ///< of the round before
  std::vector<double> rate_;
  std::vector<double> last_rate_;                       ///< of the round before
  std::vector<double> colliding_;                       ///< lost by chance per lone cycle
  std::vector<double> queued_;                          ///< waited in queues per lone cycle
  std::vector<double> free_rate_;                       ///< rate without units that serve in turn
  std::array<std::vector<double>, kUnitCount> limits_;  ///< highest rate that each unit allows
  std::vector<double> demand_;
  std::vector<UnitRequest> requests_;
};

}  // namespace leviosim::sim
