// A cluster of worker cores and a master that executes the steps of a job one after the other:
// serial work by the master, forks on the team, DMA transfers that the master waits for.
//
// Models: the path of a team fork (dispatch by the master, wake-up of the workers, barrier at the
// end; a fork right after another finds masks and code as that left them), DMA programming,
// latency, payload and completion (dma.h), contention within a team (team.h).
//
// Nothing outside of the cluster changes how long a job takes once it has begun, so the whole job
// is timed in one go, from step to step; processes in simulated time only await its end.
#pragma once

#include <span>
#include <vector>

#include "sim/chip/dma.h"
#include "sim/chip/team.h"
#include "sim/chip/timing.h"
#include "sim/events/kernel.h"
#include "sim/events/task.h"
#include "sim/work/program.h"

namespace leviosim::sim {

class Cluster {
 public:
  /// In the place of a number of workers: the master executes all shares itself, one after the
  /// other and without forks, as a program that was built for one core does.
  static constexpr int kMasterAlone = -1;

  /// @param workers  size of the team, ≤ config.max_workers, or kMasterAlone
  Cluster(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers);

  /// The master runs the job, which begins at that time. If the job was recorded for another number
  /// of workers, worker w of W runs shares w, w+W, … one after the other.
  JobTiming time(const work::Job& job, Time begin);
  /// co_await: the same from now on, until it is done. One job at a time.
  Task<JobTiming> run(const work::Job& job);

  /// As of Team; jobs outlive the memory.
  void remember(TeamMemory* memory) { team_.remember(memory); }
  void recall(const TeamMemory* memory) { team_.recall(memory); }

  /// Whether the timings of jobs hold their steps, for who wants to see what each core did when.
  void keep_steps(bool keep) { keep_steps_ = keep; }
  /// Whether their accounts are by fork and kind of operation, too.
  void keep_forks(bool keep) { keep_forks_ = keep; }

  const ClockDomain& clock() const { return clock_; }
  const ClusterConfig& config() const { return config_; }
  int workers() const { return workers_; }

 private:
  StageTiming time_stage(const work::StageRun& stage);
  void step(const work::Serial& serial, CycleAccount& account);
  void step(const work::Fork& fork, CycleAccount& account);
  void step(const work::Transfer& transfer, CycleAccount& account);
  void step(const work::TransferWait& wait, CycleAccount& account);
  void run_alone(const work::Fork& fork, CycleAccount& account);
  void until_arrived(Cycles arrival);
  /// One core works, and the others wait. Returns what its cycles were spent on.
  /// @param step  that it is
  MechanismCycles execute(const work::Segment& segment, OperationAccounts* by_operation,
                          const void* step);
  /// The shares of a fork that begin then, the master's, if it takes part, last.
  std::span<TeamShare> shares_of(const work::Fork& fork, Cycles of_workers, Cycles of_master,
                                 ForkAccount* of_fork);
  /// The worker's share; where it has several, their sum.
  const work::Segment& shares_of(int id, const work::Fork& fork);
  /// Cores whose cycles an account adds up.
  int accounted() const { return workers_ > 0 ? workers_ : 1; }
  /// What the team waited for a transfer since `begin`.
  void book_transfer(CycleAccount& account, Cycles begin);
  /// Null where forks are not asked for.
  ForkAccount* fork_in(CycleAccount& account, std::string_view name, double weight) const;
  /// Of a core that has done its work.
  void note(const TeamShare& share);
  Time at(Cycles instant) const { return job_begin_ + clock_.duration(instant); }
  double cycles_since(Cycles begin) const { return static_cast<double>((now_ - begin).count()); }

  Kernel& kernel_;
  const ClockDomain& clock_;
  ClusterConfig config_;
  int workers_;
  Team team_;  ///< the workers and, last, the master
  Dma dma_;
  bool keep_steps_ = false;
  bool keep_forks_ = false;
  // Of the job that is timed; instants are in cycles since it began.
  Time job_begin_;
  Cycles now_;
  std::vector<Cycles> background_;  ///< arrivals of background transfers
  bool after_fork_ = false;         ///< the step before was a fork
  StepTiming* step_ = nullptr;      ///< that is timed, if steps are kept
  std::vector<TeamShare> shares_;
  std::vector<work::Segment> sums_;  ///< of shares of a worker, by worker
};

}  // namespace leviosim::sim
