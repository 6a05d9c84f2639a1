// The machine as a workload sees it: a memory of its own, an L2 behind it, a team of workers. This
// is the whole interface between workload and simulator.
//
//   auto stage = machine.stage("feature extraction");
//   work::Arena::Frame frame(machine.local());
//   auto image = machine.local().alloc<P::Span<Byte>>("image", w * h);
//   machine.copy_in(image, image_in_l2);                     // DMA
//   machine.fork("detect", [&](work::Core& core) { … });     // every worker, its share
//   …                                                        // all else: serial, on the master
//
// Bodies run natively, one after the other, in the order of the core ids; a recording machine takes
// what they counted as each core's share of work. A machine that does not record costs nothing.
#pragma once

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/work/arena.h"
#include "sim/work/code_tracker.h"
#include "sim/work/policy.h"
#include "sim/work/program.h"

namespace leviosim::work {

/// Contiguous share [begin, end) of `n` items for core `id` of `cores`, sizes differing by one at
/// most.
struct Share {
  int begin;
  int end;
};
constexpr Share share_of(int n, int id, int cores) {
  const int base = n / cores;
  const int extra = n % cores;
  const int begin = id * base + std::min(id, extra);
  return {begin, begin + base + (id < extra ? 1 : 0)};
}

/// One worker inside a fork.
struct Core {
  int id;
  int cores;
  Arena& scratch;  ///< this core's part of the free local memory

  Share share(int n) const { return share_of(n, id, cores); }
};

struct MachineConfig {
  int cores = 8;                   ///< workers of the team; 1 for a controller without a cluster
  std::string_view memory = "L1";  ///< name of the local memory
  Bytes capacity{128 * 1024};      ///< of the local memory
  int alignment = 4;               ///< of blocks, in bytes; 1 packs them
  bool record = false;             ///< keep a Job of what was done
  bool offload = true;             ///< … and in it what offload regions did, for accelerators
  const CodeMap* code = nullptr;   ///< sizes of the workload's compiled code; outlives the machine
  Bytes external{0};  ///< what lies behind L2, where that is the local memory; 0: nothing does
};

class Machine {
 public:
  explicit Machine(const MachineConfig& config);

  int cores() const { return config_.cores; }
  bool recording() const { return config_.record; }
  Arena& local() { return local_; }
  const Arena& local() const { return local_; }
  /// For what has no room in local memory: external memory, if that is L2, or what a workload has
  /// set aside of L2, if that is L1. Its capacity is 0 where there is none.
  Arena& behind() { return behind_; }
  const Arena& behind() const { return behind_; }
  /// Takes `behind` as behind(), for blocks that do not leave `kept` bytes of local memory free.
  void set_behind(Arena behind, Bytes kept);
  /// Whether a block is to lie in local memory: if it leaves enough free, or nothing lies behind.
  bool has_room(Bytes block) const {
    return behind_.capacity() == Bytes(0) || block + kept_ <= local_.free();
  }

  /// While alive, work belongs to the stage of this name (a string literal). Stages do not nest.
  class Stage {
   public:
    Stage(Machine& machine, std::string_view name) : machine_(&machine) {
      machine.begin_stage(name);
    }
    ~Stage() { machine_->end_stage(); }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

   private:
    Machine* machine_;
  };
  [[nodiscard]] Stage stage(std::string_view name) { return Stage(*this, name); }

  /// Runs body(core) for every worker; the master waits for all of them. Where the free memory has
  /// no room for the scratch of all, as many as have it share the work, and the others wait.
  /// @param scratch  that each worker takes
  /// @throws MemoryOverflow if there is no room for the scratch of one
  template <class Body>
  void fork(std::string_view name, Body&& body, Bytes scratch = Bytes(0)) {
    begin_fork(name);
    run_shares(workers_with(scratch), body);
    end_fork();
  }

  /// The same; the program of one core has another order of allocations, in which no word
  /// straddles.
  template <class Body>
  void fork_aligned_on_one_core(std::string_view name, Body&& body, Bytes scratch = Bytes(0)) {
    begin_fork(name);
    fork_.aligned_on_one_core = true;
    run_shares(workers_with(scratch), body);
    end_fork();
  }

  /// Runs parallel work with the master as one more core, whose id is the last.
  template <class Body>
  void fork_with_master(std::string_view name, Body&& body) {
    begin_fork(name);
    fork_.master_takes_part = true;
    run_shares(config_.cores + 1, body);
    end_fork();
  }

  /// DMA from the memory behind into local memory, and back: from L2, or from external memory where
  /// L2 is the local one and there is any. The host copies at once.
  template <class To, class From>
  void copy_in(To to, From from) {
    copy(inwards(), to, from, false);
  }
  template <class To, class From>
  void copy_out(To to, From from) {
    copy(outwards(), to, from, false);
  }

  /// DMA in the background. The host copies at once; on the chip the data are there after wait(),
  /// which every transfer needs in the same job.
  /// @param more  of the bytes, what would not move if the block stayed in local memory
  class Ticket {
   public:
    Ticket() = default;

   private:
    friend class Machine;
    explicit Ticket(std::int32_t number) : number_(number) {}
    std::int32_t number_ = -1;
  };
  template <class To, class From>
  [[nodiscard]] Ticket start_copy_in(To to, From from, Bytes more = Bytes(0)) {
    copy(inwards(), to, from, true, more);
    return Ticket(background_transfers_++);
  }
  template <class To, class From>
  [[nodiscard]] Ticket start_copy_out(To to, From from, Bytes more = Bytes(0)) {
    copy(outwards(), to, from, true, more);
    return Ticket(background_transfers_++);
  }
  void wait(Ticket ticket);

  /// What was recorded since the last call.
  Job take_job();

  /// Counts a tile of a block that passes through the local memory (tiles.h).
  void note_tile(std::string_view block, Bytes bytes);
  /// What has passed so far, in the order of its first tiles.
  const std::vector<Passage>& passages() const { return passages_; }

  /// Keys of the pieces of code that were executed and whose size is not known, which therefore
  /// cost no fetches (code_tracker.h). Empty if no code was followed.
  std::set<std::uint64_t> code_without_size() const {
    return tracker_ ? tracker_->without_size() : std::set<std::uint64_t>{};
  }

 private:
  bool behind_is_external() const { return config_.external > Bytes(0); }
  Direction inwards() const {
    return behind_is_external() ? Direction::ExternalToL2 : Direction::L2ToL1;
  }
  Direction outwards() const {
    return behind_is_external() ? Direction::L2ToExternal : Direction::L1ToL2;
  }
  template <class To, class From>
  void copy(Direction direction, To to, From from, bool background, Bytes more = Bytes(0)) {
    const auto n = static_cast<std::size_t>(std::min(to.size(), from.size()));
    static_assert(sizeof(*to.data()) == sizeof(*from.data()));
    if (n > 0) std::memcpy(static_cast<void*>(to.data()), from.data(), n * sizeof(*to.data()));
    note_transfer(
        {direction, Bytes(static_cast<std::int64_t>(n * sizeof(*to.data()))), background, more});
  }

  void begin_stage(std::string_view name);
  void end_stage();
  void begin_fork(std::string_view name);
  template <class Body>
  void run_shares(int cores, Body&& body) {
    for (int id = 0; id < cores; ++id) {
      Arena scratch = local_.lend("scratch", cores, id);
      Core core{id, cores, scratch};
      follow_code_of(id);
      body(core);
      end_share(scratch.peak());
    }
    for (int id = cores; id < config_.cores; ++id) {
      follow_code_of(id);
      end_share(Bytes(0));
    }
  }
  /// For how many workers the free memory has this much scratch.
  int workers_with(Bytes scratch) const;
  void end_share(Bytes scratch_peak);
  void end_fork();
  void note_transfer(const Transfer& transfer);
  void flush_serial();
  /// By the core that the host executes at the moment, since this was last asked.
  static Segment counted_so_far();
  /// From now on the host executes the code of this core; the master's id is cores().
  void follow_code_of(int core);
  /// Whose history of code this core's work belongs to. A program of one core has no forks: what it
  /// does between two shares is fetched anew after each, as the share's own code has taken its
  /// place.
  int code_of(int core) const { return config_.cores == 1 ? 0 : core; }

  MachineConfig config_;
  Arena local_;
  Arena behind_;
  Bytes kept_{0};  ///< of local memory, by blocks that may lie behind it
  Job job_;
  bool in_stage_ = false;
  std::int32_t background_transfers_ = 0;  ///< of the job so far
  std::int32_t waits_ = 0;
  Fork fork_;
  Bytes scratch_sum_{0};
  Bytes scratch_max_{0};
  MemoryPeak fork_peak_;  ///< of the forks of the stage so far
  std::string_view stage_;
  std::vector<Passage> passages_;
  std::optional<CodeTracker> tracker_;  ///< of the cores (code_of), if their code is known
};

}  // namespace leviosim::work
