// A source of recorded work refuses memories that the work does not fit in, and begins what can
// begin.
#include "tools/app/run/trace_source.h"

#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {
namespace {

/// One frame with one stage, which needs 900 bytes with the scratch of all cores, 500 with that of
/// one.
traces::WorkTrace trace_with_scratch() {
  work::StageRun stage{"scratch", {work::Serial{}}, {}};
  stage.memory.parallel = Bytes(900);
  stage.memory.single = Bytes(500);
  stage.memory.blocks = {{"scratch", Bytes(0), Bytes(900)}};
  traces::WorkFrame frame;
  frame.source = name_of(PoseSource::First);
  frame.front_end.stages = {stage};
  traces::WorkTraceWriter writer(8);
  writer.add(frame);
  return traces::WorkTrace("scratch", writer.finish({}));
}

TEST(TraceSource, TheScratchOfAllCoresHasToFit) {
  const traces::WorkTrace trace = trace_with_scratch();
  for (const int bytes : {900, 899, 500}) {
    SCOPED_TRACE(bytes);
    TraceSource source(trace, Bytes(bytes), Bytes(1000));
    source.begin_frame({});
    FrameResult result;
    if (bytes == 900) {
      EXPECT_EQ(source.process(result).stages.at(0).memory.single, Bytes(500));
      continue;
    }
    try {
      source.process(result);
      ADD_FAILURE() << "was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("the recorded work occupies 900 bytes of L1"),
                std::string::npos)
          << error.what();
    }
  }
}

// An optimisation of the recording that would not have begun here is left out.
TEST(TraceSource, NoOptimisationBeginsWhileTheOptimiserIsBusy) {
  traces::WorkFrame frame;
  frame.source = name_of(PoseSource::First);
  frame.optimised = true;
  frame.iterations = {work::Job{}};
  traces::WorkTraceWriter writer(8);
  writer.add(frame);
  const traces::WorkTrace trace("busy", writer.finish({}));
  for (const bool busy : {false, true}) {
    SCOPED_TRACE(busy);
    TraceSource source(trace, Bytes(1000), Bytes(1000));
    EXPECT_EQ(source.begin_frame({.optimiser_busy = busy}), !busy);
    EXPECT_EQ(source.iterations(), busy ? 0 : 1);
    EXPECT_EQ(source.comparisons().at(0).replayed.optimised, !busy);
  }
}

}  // namespace
}  // namespace leviosim::tools
