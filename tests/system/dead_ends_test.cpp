// Questions at which people who tried leviosim got stuck: each ends in an answer, or in one line
// with what helps, and what it names works.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "tests/support/program_suite.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::ProgramResult;
using Arguments = std::vector<std::string>;

/// A second of flight, recorded as `run`; `run`, `flight` and other names are of its folder.
class DeadEnds : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("dead-ends");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    expect_done({"run", "--data", path("flight"), "--record", "--out", path("run"), "--quiet"});
    std::ofstream(path("cores.yaml"))
        << "base: { trace: run }\npoints: { grid: { platform.cluster.workers: [4, 8] } }\n";
    std::ofstream(path("anew.yaml")) << "base: { data: flight, platform: gap9 }\n"
                                        "points: { grid: { platform.cluster.workers: [4, 8] } }\n";
    std::ofstream(path("sizes.yaml"))
        << "base: { trace: run }\npoints:\n  - latin_hypercube:\n      number: 3\n      over:\n"
           "        platform.cluster.l1.size: { from: 128KiB, to: 512KiB, scale: powers_of_two }\n"
           "        platform.cluster.fpu.units: { from: 1, to: 8 }\n";
    std::ofstream(path("missed.yaml")) << "budgets:\n  - limits: [frame cycles <= 1 kcycles]\n";
    std::ofstream(path("two.yaml"))
        << "budgets:\n  - limits: [frame cycles <= 1 kcycles, L1 peak <= 1 kB]\n";
  }
};

struct Question {
  const char* name;
  Arguments words;
  int status;
  Arguments says;         ///< in what is printed, whichever stream
  Arguments then = {};    ///< what was named works
  Arguments unsaid = {};  ///< what it must not say
};

std::vector<Question> questions() {
  const Arguments l1{"-p", "cluster.workers=16", "-p", "cluster.max_workers=16"};
  return {
      {"where do I begin", {}, 0, {"leviosim demo"}},
      {"are sixteen cores worth it",
       {"whatif", "run", "cluster.workers=16"},
       0,
       {"in short: ", "with cluster.max_workers=16"}},
      {"are sixteen cores idle", {"whatif", "run", "cluster.workers=4"}, 0, {"cluster.workers=4"}},
      {"which cores have nothing to do",
       {"run", "-p", "cluster.workers=16", "-p", "cluster.max_workers=16", "-p",
        "workload.ransac_batch=8", "--data", "flight", "--frames", "0:4", "--out", "idle",
        "--quiet"},
       0,
       {"8 of 16 cores have no hypothesis"},
       {"run", "-p", "cluster.workers=16", "-p", "cluster.max_workers=16", "-p",
        "workload.ransac_batch=0", "--data", "flight", "--frames", "0:4", "--out", "busy",
        "--quiet"}},
      {"sixteen cores on a table of chips",
       {"platforms", "feasibility", "gap9", l1[0], l1[1], l1[2], l1[3], "--data", "flight",
        "--frames", "0:4", "--quiet"},
       0,
       {"gap9"}},
      {"stages of a chip that cannot be",
       {"platforms", "stages", "gap9", "gap8", "-p", "cluster.l1.size=4KiB", "--data", "flight",
        "--frames", "0:4", "--quiet"},
       2,
       {"short of L1", "platforms feasibility"}},
      {"a slower clock missed its limit",
       {"check", "run", "--budget", "missed.yaml", "-p", "cluster.clock=240MHz", "--quiet"},
       1,
       {"NOT MET"}},
      {"which of two limits is accepted",
       {"budget", "accept", "run", "--budget", "two.yaml", "--reason", "why", "--until",
        "2099-01-01"},
       2,
       {"--limit"},
       {"budget", "accept", "run", "--budget", "two.yaml", "--reason", "why", "--until",
        "2099-01-01", "--limit", "frame cycles <= 1 kcycles"}},
      {"what should I buy", {"whatif", "run", "--quiet"}, 0, {"in short: fastest is "}},
      {"why was a frame slow", {"why", "run"}, 0, {"frame ", "its own work took"}},
      {"what is Xpulp worth",
       {"whatif", "run", "isa.base=rv32imfc"},
       0,
       {"isa.base=rv32imfc", "% time"}},
      {"code without the instruction set",
       {"whatif", "run", "isa.code=rv32imfc"},
       2,
       {"expected isa.base=rv32imfc"},
       {"whatif", "run", "isa.base=rv32imfc"}},
      {"another technology",
       {"whatif", "run", "technology=12nm"},
       2,
       {"scaling between technologies is not modelled"}},
      {"the pipeline without a part",
       {"run", "-p", "workload.epnp=off", "--data", "flight", "--out", "no"},
       2,
       {"levio-no-imu-no-epnp"},
       {"run", "--profile", "levio-no-imu-no-epnp", "--data", "flight", "--frames", "0:4", "--out",
        "no-epnp", "--quiet"}},
      {"the same as a what-if",
       {"whatif", "run", "workload.window=4"},
       2,
       {"leviosim run -p workload.window=4"}},
      {"which clock is enough",
       {"tune", "--data", "flight", "--seed", "1", "--quiet", "--cache", "cache"},
       -1,
       {"verdict: ", "370"}},
      {"other numbers of cores over a trace",
       {"sweep", "cores.yaml", "--out", "cores"},
       2,
       {"base: { data: "},
       {"sweep", "anew.yaml", "--out", "anew", "--quiet", "--cache", "cache"}},
      {"sizes that exist",
       {"sweep", "sizes.yaml", "--list"},
       0,
       {"KiB"},
       {"sweep", "sizes.yaml", "--out", "sizes", "--quiet", "--cache", "cache"},
       {"units ", "5KiB"}},
      {"how long does it take",
       {"sweep", "sizes.yaml", "--status"},
       0,
       {"in short: 0 of 3", "each"}},
      {"an L1 that is too small",
       {"run", "-p", "cluster.l1.size=4KiB", "--data", "flight", "--out", "no"},
       2,
       {"GAP9", "fit in L1", "is the least", "leviosim platforms feasibility"},
       {"platforms", "feasibility", "--data", "flight", "--frames", "0:4", "--quiet"}},
      {"why natively another error",
       {"run", "--native", "--data", "flight", "--out", "native", "--quiet"},
       0,
       {"natively the optimiser takes no time"}},
      {"what measuring needs", {"doctor"}, 0, {"picolibc-riscv64-unknown-elf", "libcapstone-dev"}},
  };
}

/// With the paths of what lies in the suite's folder.
Arguments placed(const Arguments& words,
                 const std::function<std::string(const std::string&)>& path) {
  Arguments all = words;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i] == "run" || all[i] == "flight" || all[i] == "cache" || all[i].ends_with(".yaml") ||
        words[i - 1] == "--out")
      all[i] = path(all[i]);
  return all;
}

TEST_F(DeadEnds, EndInAnAnswerOrInOneHintThatWorks) {
  for (const Question& question : questions()) {
    SCOPED_TRACE(question.name);
    const ProgramResult result = program(placed(question.words, path));
    const std::string said = result.out + result.err;
    if (question.status >= 0) {
      EXPECT_EQ(result.status, question.status) << said;
    } else {
      EXPECT_LE(result.status, 1) << said;
    }
    for (const std::string& part : question.says)
      EXPECT_NE(said.find(part), std::string::npos) << part << "\n" << said;
    for (const std::string& part : question.unsaid)
      EXPECT_EQ(said.find(part), std::string::npos) << part << "\n" << said;
    if (result.status == 2) {
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    if (question.then.empty()) continue;
    const ProgramResult then = program(placed(question.then, path));
    EXPECT_EQ(then.status, 0) << then.out << then.err;
  }
}

}  // namespace
}  // namespace leviosim::tools
