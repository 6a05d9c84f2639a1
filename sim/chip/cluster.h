// A cluster of worker cores and a master that executes the steps of a job one after the other:
// serial work by the master, forks on the team, DMA transfers that the master waits for.
//
// Models: the path of a team fork (dispatch by the master, wake-up of the workers, barrier at the
// end; a fork right after another finds masks and code as that left them), DMA programming,
// latency, payload and completion (dma.h), contention within a team (team.h).
#pragma once

#include <memory>
#include <vector>

#include "sim/chip/dma.h"
#include "sim/chip/team.h"
#include "sim/chip/timing.h"
#include "sim/events/channel.h"
#include "sim/work/program.h"

namespace leviosim::sim {

class Cluster {
 public:
  /// In the place of a number of workers: the master executes all shares itself, one after the
  /// other and without forks, as a program that was built for one core does.
  static constexpr int kMasterAlone = -1;

  /// @param workers  size of the team, ≤ config.max_workers, or kMasterAlone
  Cluster(Kernel& kernel, const ClockDomain& clock, const ClusterConfig& config, int workers);

  /// co_await: the master runs the job. If the job was recorded for another number of workers,
  /// worker w of W runs shares w, w+W, … one after the other. One job at a time.
  Task<JobTiming> run(const work::Job& job);

  /// Whether the timings of jobs hold their steps, for who wants to see what each core did when.
  void keep_steps(bool keep) { keep_steps_ = keep; }
  /// Whether their accounts are by fork and kind of operation, too.
  void keep_forks(bool keep) { keep_forks_ = keep; }

  const ClockDomain& clock() const { return clock_; }
  int workers() const { return workers_; }

 private:
  /// What a worker is sent: its shares, and where it reports to.
  struct Dispatch {
    const work::Fork* fork;
    CycleAccount* account;
    ForkAccount* of_fork;  ///< in it; null where forks are not asked for
    Time begin;            ///< of the fork
    Duration start_up;     ///< until the share begins
  };

  Process worker(int id);
  Task<> run_alone(const work::Fork& fork, CycleAccount& account);
  /// Cores whose cycles an account adds up.
  int accounted() const { return workers_ > 0 ? workers_ : 1; }
  Task<> step(const work::Serial& serial, CycleAccount& account);
  Task<> step(const work::Fork& fork, CycleAccount& account);
  Task<> step(const work::Transfer& transfer, CycleAccount& account);
  Task<> step(const work::TransferWait& wait, CycleAccount& account);
  Task<> until_arrived(Time arrival);
  /// What the team waited for a transfer since `begin`.
  void book_transfer(CycleAccount& account, Time begin);
  /// The worker's share; where it has several, their sum, which is put into `sum`.
  const work::Segment& shares_of(int id, const work::Fork& fork, work::Segment& sum) const;
  /// Null where forks are not asked for.
  ForkAccount* fork_in(CycleAccount& account, std::string_view name, double weight) const;
  void begin_step(const work::Step& step, StageTiming& stage);
  void end_step();
  /// Of a core that has done its work.
  void note(int core, Time begin, const MechanismCycles& time);
  Duration cycles(double n) const;
  double cycles_since(Time begin, Time end) const;

  Kernel& kernel_;
  const ClockDomain& clock_;
  ClusterConfig config_;
  int workers_;
  Team team_;  ///< the workers and, last, the master
  Dma dma_;
  std::vector<Time> background_;  ///< arrivals of the job's background transfers
  Barrier end_of_fork_;
  std::vector<std::unique_ptr<Channel<Dispatch>>> dispatch_;
  bool keep_steps_ = false;
  bool keep_forks_ = false;
  bool after_fork_ = false;     ///< the step before was a fork
  StepTiming* step_ = nullptr;  ///< that runs, if steps are kept
  Time last_arrival_;
  double arrivals_ =
      0;  ///< arrival times of the workers after the begin of the fork, summed, cycles
};

}  // namespace leviosim::sim
