// The benchmark networks as SystemC processes: SC_THREAD, and SC_METHOD with explicit states.
//
// SystemC elaborates once per host process, so all networks exist from the start, asleep; a run
// notifies one of them and calls sc_start() until no activity is left.
#pragma once

// Debian's libsystemc is built as C++17 and refuses, at link time, users that say otherwise.
#define SC_CPLUSPLUS 201703L

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <systemc>
#include <vector>

#include "tests/bench/event_kernel_networks.h"

namespace leviosim::bench::systemc {

using sc_core::sc_event;
using sc_core::sc_module;
using sc_core::sc_module_name;
using sc_core::sc_time;

inline sc_time cycles(int count) {
  static const sc_time cycle(1, sc_core::SC_NS);
  return sc_time::from_value(cycle.value() * static_cast<std::uint64_t>(count));
}

class Network {
 public:
  RunResult run() {
    const sc_time begin = sc_core::sc_time_stamp();
    steps_ = 0;
    start_.notify(sc_core::SC_ZERO_TIME);
    sc_core::sc_start();
    const auto elapsed = (sc_core::sc_time_stamp() - begin).value() / cycles(1).value();
    return {steps_, static_cast<std::int64_t>(elapsed)};
  }

  sc_event start_;
  std::int64_t steps_ = 0;
};

/// Makes one module per process, named uniquely.
template <class Module, class Net>
void add_modules(std::vector<std::unique_ptr<sc_module>>& modules, Net& net, std::size_t first,
                 std::size_t end) {
  for (std::size_t id = first; id < end; ++id)
    modules.push_back(std::make_unique<Module>(sc_core::sc_gen_unique_name("process"), net, id));
}

// ---- DelayBarrier ----------------------------------------------------------------------------

struct DelayBarrierNet : Network {
  DelayBarrierNet(std::size_t parties, int round_count) : processes(parties), rounds(round_count) {}
  void arrive() {
    if (++arrived < processes) return;
    arrived = 0;
    release.notify(latency);
  }

  sc_event release;
  const sc_time latency = cycles(kBarrierLatency);
  std::size_t processes;
  std::size_t arrived = 0;
  int rounds;
};

struct DelayBarrierThread : sc_module {
  SC_HAS_PROCESS(DelayBarrierThread);
  DelayBarrierThread(sc_module_name, DelayBarrierNet& network, std::size_t id)
      : net(network), delays(id) {
    SC_THREAD(work);
  }
  void work() {
    for (;;) {
      wait(net.start_);
      std::size_t n = 0;
      for (int round = 0; round < net.rounds; ++round) {
        for (int i = 0; i < kDelaysPerBarrier; ++i, ++net.steps_) wait(cycles(delays[n++]));
        net.arrive();
        wait(net.release);
        ++net.steps_;
      }
    }
  }
  DelayBarrierNet& net;
  DelayTable delays;
};

struct DelayBarrierMethod : sc_module {
  SC_HAS_PROCESS(DelayBarrierMethod);
  DelayBarrierMethod(sc_module_name, DelayBarrierNet& network, std::size_t id)
      : net(network), delays(id) {
    SC_METHOD(work);
  }
  /// `step` counts the waits of a run: 0 before it, then 8 delays and a barrier per round.
  void work() {
    const int per_round = kDelaysPerBarrier + 1;
    if (step == 0) {
      step = 1;
      next_trigger(net.start_);
      return;
    }
    net.steps_ += step > 1 ? 1 : 0;
    if (step > net.rounds * per_round) {
      step = 1;
      n = 0;
      next_trigger(net.start_);
      return;
    }
    if (step++ % per_round != 0) {
      next_trigger(cycles(delays[n++]));
    } else {
      net.arrive();
      next_trigger(net.release);
    }
  }
  DelayBarrierNet& net;
  DelayTable delays;
  int step = 0;
  std::size_t n = 0;
};

// ---- Ring ------------------------------------------------------------------------------------

struct RingNet : Network {
  RingNet(std::size_t processes, int round_count) : events(processes), rounds(round_count) {}
  sc_event& next(std::size_t id) { return events[(id + 1) % events.size()]; }

  std::deque<sc_event> events;
  int rounds;
};

struct RingThread : sc_module {
  SC_HAS_PROCESS(RingThread);
  RingThread(sc_module_name, RingNet& network, std::size_t id)
      : net(network), mine(net.events[id]), next(net.next(id)) {
    if (id == 0) {
      SC_THREAD(start_rounds);
    } else {
      SC_THREAD(pass_on);
    }
  }
  void start_rounds() {
    for (;;) {
      wait(net.start_);
      for (int round = 0; round < net.rounds; ++round, net.steps_ += 2) {
        wait(cycles(1));
        next.notify(sc_core::SC_ZERO_TIME);
        wait(mine);
      }
    }
  }
  void pass_on() {
    for (;; ++net.steps_) {
      wait(mine);
      next.notify(sc_core::SC_ZERO_TIME);
    }
  }
  RingNet& net;
  sc_event& mine;
  sc_event& next;
};

struct RingMethod : sc_module {
  SC_HAS_PROCESS(RingMethod);
  RingMethod(sc_module_name, RingNet& network, std::size_t id)
      : net(network), mine(net.events[id]), next(net.next(id)) {
    if (id == 0) {
      SC_METHOD(start_rounds);
    } else {
      SC_METHOD(pass_on);
      sensitive << mine;
      dont_initialize();
    }
  }
  void start_rounds() {
    switch (state) {
      case Idle:
        state = Waiting;
        round = 0;
        next_trigger(net.start_);
        return;
      case Notifying:
        ++net.steps_;
        next.notify(sc_core::SC_ZERO_TIME);
        state = Token;
        next_trigger(mine);
        return;
      case Token:
        ++net.steps_;
        ++round;
        break;
      case Waiting:
        break;
    }
    if (round == net.rounds) {
      state = Waiting;
      round = 0;
      next_trigger(net.start_);
      return;
    }
    state = Notifying;
    next_trigger(cycles(1));
  }
  void pass_on() {
    ++net.steps_;
    next.notify(sc_core::SC_ZERO_TIME);
  }
  enum State { Idle, Waiting, Notifying, Token };
  RingNet& net;
  sc_event& mine;
  sc_event& next;
  State state = Idle;
  int round = 0;
};

// ---- Pipeline --------------------------------------------------------------------------------

using Fifo = sc_core::sc_fifo<int>;

struct PipelineNet : Network {
  PipelineNet(std::size_t process_count, int value_count)
      : processes(process_count), values(value_count) {
    for (std::size_t p = 0; p + 1 < processes; ++p) fifos.emplace_back(kFifoDepth);
  }
  /// The producer has no input and the consumer no output: they are given what they do not use.
  Fifo& in(std::size_t process) { return fifos[process == 0 ? 0 : process - 1]; }
  Fifo& out(std::size_t process) { return fifos[process + 1 == processes ? 0 : process]; }

  std::deque<Fifo> fifos;
  std::size_t processes;
  int values;
};

struct PipelineThread : sc_module {
  SC_HAS_PROCESS(PipelineThread);
  PipelineThread(sc_module_name, PipelineNet& network, std::size_t process)
      : net(network), in(net.in(process)), out(net.out(process)), delays(process) {
    if (process == 0) {
      SC_THREAD(produce);
    } else if (process + 1 == net.processes) {
      SC_THREAD(consume);
    } else {
      SC_THREAD(work);
    }
  }
  void produce() {
    for (;;) {
      wait(net.start_);
      for (int value = 0; value < net.values; ++value, ++net.steps_) out.write(value);
    }
  }
  void work() {
    for (std::size_t n = 0;; net.steps_ += 3) {
      const int value = in.read();
      wait(cycles(delays[n++]));
      out.write(value + 1);
    }
  }
  void consume() {
    for (;; ++net.steps_) in.read();
  }
  PipelineNet& net;
  Fifo& in;
  Fifo& out;
  DelayTable delays;
};

/// Every activation goes as far as it can without waiting, as a hand-written method would.
struct PipelineMethod : sc_module {
  SC_HAS_PROCESS(PipelineMethod);
  PipelineMethod(sc_module_name, PipelineNet& network, std::size_t process)
      : net(network), in(net.in(process)), out(net.out(process)), delays(process) {
    if (process == 0) {
      SC_METHOD(produce);
    } else if (process + 1 == net.processes) {
      SC_METHOD(consume);
    } else {
      SC_METHOD(work);
    }
  }
  void produce() {
    if (!started) {
      started = true;
      made = net.values;
    } else if (made == net.values) {
      made = 0;
    }
    for (; made < net.values; ++made, ++net.steps_)
      if (!out.nb_write(made)) return next_trigger(out.data_read_event());
    next_trigger(net.start_);
  }
  void work() {
    if (holds_value) {
      if (!out.nb_write(value + 1)) return next_trigger(out.data_read_event());
      net.steps_ += 3;
      holds_value = false;
    }
    if (!in.nb_read(value)) return next_trigger(in.data_written_event());
    holds_value = true;
    next_trigger(cycles(delays[n++]));
  }
  void consume() {
    for (int value_read = 0; in.nb_read(value_read);) ++net.steps_;
    next_trigger(in.data_written_event());
  }
  PipelineNet& net;
  Fifo& in;
  Fifo& out;
  DelayTable delays;
  bool started = false;
  bool holds_value = false;
  int made = 0;
  int value = 0;
  std::size_t n = 0;
};

// ---- SharedRate ------------------------------------------------------------------------------

struct SharedRateNet : Network {
  SharedRateNet(std::size_t processes, int segment_count)
      : segments(segment_count), ends(processes), end_events(processes) {}
  void move_ends() {
    const sc_time now = sc_core::sc_time_stamp();
    for (std::size_t p = 0; p < ends.size(); ++p) {
      if (ends[p] <= now) continue;
      ends[p] += cycles(1);
      end_events[p].cancel();
      end_events[p].notify(ends[p] - now);
    }
  }
  int segments;
  std::vector<sc_time> ends;
  std::deque<sc_event> end_events;
};

struct SharedRateThread : sc_module {
  SC_HAS_PROCESS(SharedRateThread);
  SharedRateThread(sc_module_name, SharedRateNet& network, std::size_t process)
      : net(network), id(process), delays(process) {
    SC_THREAD(work);
  }
  void work() {
    for (;;) {
      wait(net.start_);
      std::size_t n = 0;
      for (int i = 0; i < net.segments; ++i, ++net.steps_) {
        net.ends[id] = sc_core::sc_time_stamp() + cycles(16 + delays[n++]);
        net.move_ends();
        wait(net.end_events[id]);
        net.ends[id] = sc_core::SC_ZERO_TIME;
      }
    }
  }
  SharedRateNet& net;
  std::size_t id;
  DelayTable delays;
};

struct SharedRateMethod : sc_module {
  SC_HAS_PROCESS(SharedRateMethod);
  SharedRateMethod(sc_module_name, SharedRateNet& network, std::size_t process)
      : net(network), id(process), delays(process) {
    SC_METHOD(work);
  }
  void work() {
    if (running) {
      net.ends[id] = sc_core::SC_ZERO_TIME;
      if (segment > 0) ++net.steps_;
    }
    if (!running || segment == net.segments) {
      running = true;
      segment = 0;
      n = 0;
      next_trigger(net.start_);
      return;
    }
    ++segment;
    net.ends[id] = sc_core::sc_time_stamp() + cycles(16 + delays[n++]);
    net.move_ends();
    next_trigger(net.end_events[id]);
  }
  SharedRateNet& net;
  std::size_t id;
  DelayTable delays;
  bool running = false;
  int segment = 0;
  std::size_t n = 0;
};

}  // namespace leviosim::bench::systemc
