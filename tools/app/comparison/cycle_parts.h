// Where the cycles of each stage went on N cores, finer than the breakdown of a stage: by what the
// cores did (a named fork, or the master alone), by mechanism and by kind of operation. The file
// cycles.csv of a run folder holds it.
//
// Parts are core-cycles over the cores of the team, so that the parts of a stage add up to its
// cycles. What is priced (instructions, stalls, fetched code, accelerators) is that of cost.h; what
// the cores do to each other is the breakdown's, and known for a whole stage only.
//
// Left out: named functions within a fork. Work is counted between two synchronisation points, over
// all functions that run there (README.md).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/chip/config.h"
#include "sim/chip/instruction_cache.h"
#include "sim/chip/work_sum.h"
#include "sim/work/program.h"
#include "tools/app/run/run_observer.h"

namespace leviosim::tools {

inline constexpr const char* kCyclesFile = "cycles.csv";
/// Where the master works alone.
inline constexpr const char* kSerialPlace = "serial";
/// The cycles of a frame that belong to no stage: the controller calls the cluster and is told.
inline constexpr const char* kOffloadStage = "offload";

struct Mechanism {
  std::string_view key;
  std::string_view description;
};
/// All keys that a part may have.
inline constexpr std::array kMechanisms{
    Mechanism{"issue", "instructions"},
    Mechanism{"load_use", "waiting for loaded values"},
    Mechanism{"control", "pipeline refills after branches, calls, loop entries"},
    Mechanism{"memory", "L2 latency and straddling words"},
    Mechanism{"arithmetic", "latency of divisions and floating point"},
    Mechanism{"fetch", "I-cache: code that the private cache lacks"},
    Mechanism{"accelerator", "accelerators serving the core"},
    Mechanism{"fpu", "waiting for a shared FPU"},
    Mechanism{"divider", "waiting for the shared divider"},
    Mechanism{"banks", "waiting for L1 banks"},
    Mechanism{"fetch_contention", "I-cache: other cores fetch as well"},
    Mechanism{"accelerator_contention", "accelerators serving other cores"},
    Mechanism{"imbalance", "waiting for the slowest core"},
    Mechanism{"synchronisation", "forking, waking up, barriers"},
    Mechanism{"transfer", "waiting for the DMA"},
    Mechanism{"rounding", "ends moved to clock edges, banks of the serial part"},
    Mechanism{"offload", "calling the cluster, and its answer"},
    Mechanism{"other", "small parts of a baseline"},
};
/// Empty if there is no such key.
std::string_view describe_mechanism(std::string_view key);

struct CyclePart {
  std::string where;      ///< name of a fork, kSerialPlace, or empty: the team as a whole
  std::string mechanism;  ///< a key of kMechanisms
  std::string operation;  ///< kind of operation or kernel; empty if it is not by operation
  double cycles = 0;      ///< of the stage, over all calls
  double count = 0;       ///< operations, bytes of code, items of kernels; 0: nothing to count
};

struct StageParts {
  std::string stage;
  bool on_controller = false;
  double cycles = 0;  ///< on N cores, over all calls
  std::vector<CyclePart> parts;
};

class PartList;

/// Looks on while a run happens and adds up what its jobs did.
class CycleParts : public RunObserver {
 public:
  /// @param cores  of the team
  CycleParts(const sim::ChipConfig& chip, int cores);

  void on_front_end(const FrontEndJob& job) override;
  void on_optimiser(const OptimiserJob& job) override;

  /// The stages in the order in which they came first, and last what is no stage's.
  std::vector<StageParts> stages() const;

 private:
  struct Place {
    std::string name;
    work::Segment all;
    sim::WorkSum left;  ///< … to the cores, without what accelerators serve
    double fetch = 0;   ///< core-cycles that code took; not the price of the sum
  };
  struct Stage {
    std::string name;
    bool on_controller = false;
    std::int64_t cycles = 0;
    sim::CycleBreakdown breakdown;
    std::vector<Place> places;
  };

  Stage& find(std::string_view name, bool on_controller);
  static Place& place(Stage& stage, std::string_view name);
  void add_segment(const Stage& stage, Place& place, const work::Segment& segment) const;
  const sim::Accelerators& accelerators_of(const Stage& stage) const;
  const sim::CoreConfig& core_of(const Stage& stage) const;
  void add(const work::Job& job, const sim::JobTiming& timing, bool on_controller);
  void add_steps(Stage& stage, const work::StageRun& run);
  void add_fork(Stage& stage, const work::Fork& fork);
  double add_priced(PartList& list, const Stage& stage, const Place& place, double factor) const;
  void divide_fetches(std::vector<Place>& places, double cycles) const;

  sim::ChipConfig chip_;
  int cores_;
  sim::CodeFetcher worker_code_;
  sim::CodeFetcher master_code_;
  sim::CodeFetcher controller_code_;
  std::vector<Stage> stages_;
  std::int64_t offload_cycles_ = 0;
};

/// The same with parts below a share of the stage's cycles made one, the mechanism "other".
StageParts folded(const StageParts& stage, double least_share);
/// The same with all parts made one that another stage does not have.
StageParts folded_like(const StageParts& stage, const StageParts& other);

/// A row per part: stage,runs_on,where,mechanism,operation,cycles,count.
std::string cycles_csv(const std::vector<StageParts>& stages);

/// The inverse. @throws InputError naming file and line
std::vector<StageParts> parse_cycles(const std::filesystem::path& file, std::string text);

}  // namespace leviosim::tools
