// The timeline of work that is known: what lies where, what is joined, and what it costs.
#include "sim/work/op.h"
#include "tools/app/timeline/joined_steps.h"
#include "tools/app/timeline/perfetto_timeline.h"
#include "tools/app/timeline/requested_timeline.h"
#include "tools/app/timeline/timeline_collector.h"
#include "tools/app/timeline/timeline_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>

#include "tests/tools/constant_source.h"
#include "tests/tools/timeline_checks.h"
#include "tests/tools/well_formed.h"
#include "tests/traces/test_folder.h"
#include "tools/app/timeline/protobuf_writer.h"
#include "tools/app/timeline/track_events.h"
#include "tools/app/timeline/waits.h"

namespace leviosim::tools {
namespace {

using testing::expect_sums_of;
using tests::PerfettoEvent;
using tests::PerfettoTrace;
using tests::ProtoReader;
using traces::testing::expect_input_error;
using work::Op;

work::Segment segment(std::uint64_t alu, std::uint64_t fpu = 0, std::uint64_t divisions = 0) {
  work::Segment counts;
  counts[Op::IntAlu] = alu;
  counts[Op::F32Add] = fpu;
  counts[Op::F32Div] = divisions;
  return counts;
}

work::Fork fork(std::string_view name, int shares, std::uint64_t alu, std::uint64_t fpu,
                std::uint64_t divisions) {
  work::Fork fork{name, {}, false};
  for (int i = 0; i < shares; ++i)
    fork.shares.push_back(segment(alu + 17 * static_cast<std::uint64_t>(i), fpu, divisions));
  return fork;
}

/// Every kind of step, in two stages; the second has many short ones.
class MixedSource : public testing::ConstantSource {
 public:
  MixedSource(const testing::ConstantWork& constant, int cores, int short_forks)
      : ConstantSource(constant) {
    const work::Transfer in{work::Direction::L2ToL1, Bytes(4800)};
    const work::Transfer out{work::Direction::L1ToL2, Bytes(123)};
    const work::Transfer behind{work::Direction::L2ToL1, Bytes(800), true};
    work::Fork with_master = fork("with the master", cores + 1, 300, 100, 3);
    with_master.master_takes_part = true;
    work::StageRun first{"first",
                         {in, work::Serial{segment(321, 7)}, fork("heavy", cores, 5000, 3000, 40),
                          behind, with_master, work::TransferWait{0}, out},
                         {}};
    first.memory.parallel = Bytes(777);
    work::StageRun second{"second", {}, {}};
    for (int i = 0; i < short_forks; ++i) {
      second.steps.emplace_back(fork("short", cores, 20, 5, 1));
      second.steps.emplace_back(work::Serial{segment(11)});
      second.steps.emplace_back(out);
    }
    job_.stages = {first, second};
  }
  const work::Job& process(FrameResult& result) override {
    ConstantSource::process(result);
    return job_;
  }
  std::vector<StageResult> empty_stages() const override {
    StageResult stage;
    stage.name = "optimiser";
    stage.on_controller = true;
    return {stage};
  }

 private:
  work::Job job_;
};

struct Shown {
  RunResult run;
  std::string bytes;
  PerfettoTrace trace;
};

Shown shown(int short_forks, std::size_t most_bytes = kMostBytesOfFrame, int cores = 8,
            testing::ConstantWork constant = {.frames = 4, .iteration = 5'000},
            std::optional<Deadline> deadline = {}, std::optional<traces::FrameRange> range = {}) {
  MixedSource source(constant, cores, short_forks);
  RunRequest request = testing::request_at(Hertz(370'000'000), deadline);
  request.cores = cores;
  request.platform.config.cluster.icache.line = Bytes(0);
  std::string bytes;
  PerfettoTimeline timeline(
      request.platform.config,
      {.cores = cores, .is_closed = deadline.has_value(), .range = range, .most_bytes = most_bytes},
      [&](std::string_view piece) { bytes += piece; });
  request.observer = &timeline;
  RunResult run = simulate_source(request, source, [](const Progress&) {});
  timeline.finish(run);
  PerfettoTrace trace(bytes);
  return {std::move(run), std::move(bytes), std::move(trace)};
}

TEST(Protobuf, WritesNumbersAndMessagesAsTheirDescriptionHasIt) {
  // The examples of the description of the encoding: 150, and a message with it.
  ProtobufWriter inner;
  inner.add_uint(1, 150);
  EXPECT_EQ(inner.bytes(), "\x08\x96\x01");
  ProtobufWriter outer;
  outer.add_message(3, inner);
  EXPECT_EQ(outer.bytes(), "\x1a\x03\x08\x96\x01");
  for (const std::uint64_t value : {std::uint64_t{0}, std::uint64_t{127}, std::uint64_t{128},
                                    std::uint64_t{1} << 35, ~std::uint64_t{0}}) {
    ProtobufWriter message;
    message.add_uint(1000, value);
    message.add_fixed64(2, value);
    message.add_double(3, -0.1);
    ProtoReader reader(message.bytes());
    EXPECT_EQ(reader.next()->value, value);
    EXPECT_EQ(reader.next()->value, value);
    EXPECT_EQ(reader.next()->real(), -0.1);
    EXPECT_FALSE(reader.next());
  }
}

TEST(Timeline, AddsUpToTheRun) {
  for (const int cores : {1, 3, 8}) {
    SCOPED_TRACE(cores);
    const Shown all = shown(3, kMostBytesOfFrame, cores);
    expect_sums_of(all.trace, all.run);
    const Shown joined = shown(3, 0, cores);
    expect_sums_of(joined.trace, joined.run);
    EXPECT_LT(joined.bytes.size(), all.bytes.size());
  }
}

TEST(Timeline, IsTheSameBytesEachTime) { EXPECT_EQ(shown(5).bytes, shown(5).bytes); }

TEST(Timeline, SlicesLieWithinTheirFrameAndWaitsWithinTheirWork) {
  const Shown all = shown(3);
  const std::vector<PerfettoEvent> frames = all.trace.on("front end");
  ASSERT_EQ(std::count_if(frames.begin(), frames.end(),
                          [](const PerfettoEvent& e) {
                            return e.depth == 0 && e.type == PerfettoEvent::kBegin;
                          }),
            4);
  // Begin and end of what lies within something, as a reader nests them.
  std::map<std::uint64_t, std::vector<PerfettoEvent>> stacks;
  int waits = 0;
  for (const PerfettoEvent& event : all.trace.events()) {
    if (event.type != PerfettoEvent::kBegin) continue;
    std::vector<PerfettoEvent>& stack = stacks[event.track];
    stack.resize(static_cast<std::size_t>(event.depth));
    EXPECT_LE(event.begin_ns, event.end_ns);
    if (!stack.empty()) {
      EXPECT_GE(event.begin_ns, stack.back().begin_ns);
      EXPECT_LE(event.end_ns, stack.back().end_ns);
    }
    if (event.name.rfind("waiting for ", 0) == 0 && event.name != "waiting for the DMA") {
      ++waits;
      ASSERT_FALSE(stack.empty());
      const std::string part = event.name.substr(std::string_view("waiting for ").size());
      const double drawn = static_cast<double>(event.end_ns - event.begin_ns) * 0.37;
      EXPECT_NEAR(drawn, stack.back().number(part), 1.5) << part;
    }
    stack.push_back(event);
  }
  EXPECT_GE(waits, 4 * 8);  // of every worker for the divider
}

TEST(Timeline, CyclesAreExact) {
  const Shown all = shown(2);
  for (const char* track : {"master", "core 0", "core 7", "DMA, L2 to L1"})
    for (const PerfettoEvent& event : all.trace.on(track)) {
      if (event.numbers.count("cycle") == 0) continue;
      const std::vector<PerfettoEvent> frames = all.trace.on("front end");
      const auto stage = std::find_if(frames.begin(), frames.end(), [&](const PerfettoEvent& e) {
        return e.name == "first" && e.begin_ns <= event.begin_ns &&
               event.begin_ns < e.begin_ns + 1'000'000;
      });
      ASSERT_NE(stage, frames.end());
      const double ns = event.number("cycle") / 0.37;
      EXPECT_NEAR(static_cast<double>(event.begin_ns - stage->begin_ns), ns, 1.0) << event.name;
    }
}

TEST(Timeline, TransfersHaveTheirBytesAndDirections) {
  const Shown all = shown(2);
  double in = 0;
  double out = 0;
  for (const PerfettoEvent& event : all.trace.on("DMA, L2 to L1")) in += event.number("bytes");
  for (const PerfettoEvent& event : all.trace.on("DMA, L1 to L2")) out += event.number("bytes");
  EXPECT_EQ(in, 4 * (4800 + 800));
  EXPECT_EQ(out, 4 * 3 * 123);
}

/// Iterations that fetch so many tiles of 640 bytes from external memory, and send one back.
class ExternalSource : public MixedSource {
 public:
  explicit ExternalSource(int tiles) : MixedSource({.frames = 4, .iteration = 5'000}, 8, 1) {
    work::StageRun stage{"optimiser", {}, {}};
    for (int i = 0; i < tiles; ++i) {
      stage.steps.emplace_back(
          work::Transfer{work::Direction::ExternalToL2, Bytes(640), /*background=*/true});
      stage.steps.emplace_back(work::Serial{segment(500)});
      stage.steps.emplace_back(work::TransferWait{i});
    }
    stage.steps.emplace_back(work::Transfer{work::Direction::L2ToExternal, Bytes(64)});
    iteration_.stages = {stage};
  }
  const work::Job& optimise() override { return iteration_; }

 private:
  work::Job iteration_;
};

/// What a chip whose external memory moves 64 MB/s, after 1 µs, shows of it.
PerfettoTrace shown_external(int tiles, std::size_t most_bytes) {
  ExternalSource source(tiles);
  RunRequest request = testing::request_at(Hertz(370'000'000), {});
  request.cores = 8;
  request.platform.config.controller.external = {1e-6, 64e6, Bytes(0), Bytes(1 << 20)};
  std::string bytes;
  PerfettoTimeline timeline(request.platform.config, {.cores = 8, .most_bytes = most_bytes},
                            [&](std::string_view piece) { bytes += piece; });
  request.observer = &timeline;
  timeline.finish(simulate_source(request, source, [](const Progress&) {}));
  return PerfettoTrace(bytes);
}

TEST(Timeline, ExternalMemoryHasTracksOfItsOwn) {
  for (const std::size_t most_bytes : {std::size_t{1} << 30, std::size_t{0}}) {
    const PerfettoTrace trace = shown_external(12, most_bytes);
    const std::vector<PerfettoEvent> in = trace.on("external memory to L2"),
                                     out = trace.on("L2 to external memory");
    double fetched = 0, sent = 0;
    for (const PerfettoEvent& event : in) fetched += event.number("bytes");
    for (const PerfettoEvent& event : out) sent += event.number("bytes");
    ASSERT_GT(sent, 0);
    EXPECT_EQ(fetched / sent, 120);
    const auto iterations = static_cast<std::size_t>(sent / 64);
    if (most_bytes == 0) {
      EXPECT_EQ(in.size(), iterations);  // joined
      continue;
    }
    ASSERT_EQ(in.size(), 12 * iterations);
    EXPECT_EQ(in[0].name, "tile, external to L2");
    EXPECT_EQ(out[0].name, "L2 to external");
    EXPECT_EQ(in[0].end_ns - in[0].begin_ns, 10'000);
    const PerfettoEvent& iteration = trace.on("controller").at(1);
    EXPECT_NEAR(static_cast<double>(in[0].begin_ns - iteration.begin_ns), 1'000, 3);
    EXPECT_LE(out[0].end_ns, iteration.end_ns);
  }
  EXPECT_ANY_THROW(shown(2).trace.on("external memory to L2"));  // of a chip without
}

TEST(Timeline, TilesAreNamedOnTheTrackOfTheDma) {
  const Shown all = shown(2);
  std::map<std::string, int> names;
  for (const PerfettoEvent& event : all.trace.on("DMA, L2 to L1")) ++names[event.name];
  EXPECT_EQ(names, (std::map<std::string, int>{{"L2 to L1", 4}, {"tile, L2 to L1", 4}}));
}

TEST(Timeline, JoinsShortStepsUntilAFrameFits) {
  const Shown fits = shown(5, 1 << 30);
  EXPECT_EQ(fits.trace.on("master")[1].name, "serial work");
  for (const PerfettoEvent& event : fits.trace.events()) EXPECT_NE(event.name, "short steps");
  const Shown many = shown(400);
  expect_sums_of(many.trace, many.run);
  EXPECT_LE(many.bytes.size(), 4u * 50'000 + 5'000);
  const std::vector<PerfettoEvent> master = many.trace.on("master");
  double most = 0;
  for (const PerfettoEvent& event : master) most = std::max(most, event.number("steps"));
  EXPECT_EQ(most, 3 * 400);
  // What is long is still told apart.
  EXPECT_TRUE(std::any_of(master.begin(), master.end(),
                          [](const PerfettoEvent& e) { return e.name == "fork: heavy"; }));
}

TEST(Timeline, JoinsNeighboursOfAStageThatAreShortAndNothingElse) {
  StageEvents stage;
  const auto add = [&](std::int64_t cycles) {
    StepEvents& step = stage.steps.emplace_back();
    step.cycles = step.serial = Cycles(cycles);
  };
  for (const std::int64_t cycles : {50, 99, 100, 10, 200, 1, 2, 3}) add(cycles);
  const StageEvents joined = with_short_steps_joined(stage, Cycles(100));
  std::vector<std::int64_t> cycles;
  for (const StepEvents& step : joined.steps) cycles.push_back(step.cycles.count());
  EXPECT_EQ(cycles, (std::vector<std::int64_t>{149, 100, 10, 200, 6}));
  EXPECT_EQ(joined.steps[0].kind, StepKind::Several);
  EXPECT_EQ(joined.steps[0].steps, 2);
  EXPECT_EQ(joined.steps[0].serial, Cycles(149));
  EXPECT_EQ(joined.steps[2].kind, StepKind::Serial);
  EXPECT_EQ(joined.steps[4].steps, 3);
}

/// Arrows that begin at one and end at the other.
int arrows(const PerfettoTrace& trace, const std::string& from, const std::string& name,
           const std::string& to, const std::string& end) {
  int found = 0;
  for (const PerfettoEvent& a : trace.on(from))
    for (const PerfettoEvent& b : trace.on(to))
      for (const std::uint64_t flow : a.flows)
        found += a.name.rfind(name, 0) == 0 && b.name.rfind(end, 0) == 0 &&
                 std::count(b.flow_ends.begin(), b.flow_ends.end(), flow) > 0;
  return found;
}

TEST(Timeline, ArrowsLeadToThePoseAndToThePublication) {
  const Shown all = shown(2);
  EXPECT_EQ(arrows(all.trace, "camera", "frame", "front end", "pose"), 4);
  EXPECT_EQ(arrows(all.trace, "front end", "frame", "front end", "pose"), 4);
  EXPECT_EQ(arrows(all.trace, "front end", "snapshot", "controller", "published"),
            all.run.optimiser_published);
  EXPECT_GT(all.run.optimiser_published, 0);
}

TEST(Timeline, AClosedLoopShowsWhatIsDroppedAndLate) {
  testing::ConstantWork constant{.frames = 30, .period_ns = 40'000};
  const Shown all = shown(40, kMostBytesOfFrame, 8, constant, Deadline::Drop);
  ASSERT_TRUE(all.run.camera);
  expect_sums_of(all.trace, all.run);
  int dropped = 0;
  for (const PerfettoEvent& event : all.trace.on("camera"))
    dropped += event.number("dropped") == 1 && event.name.find("dropped") != std::string::npos;
  EXPECT_EQ(dropped, 30 - static_cast<int>(all.run.frames.size()));
  EXPECT_GT(dropped, 0);
  int missed = 0;
  for (const PerfettoEvent& event : all.trace.on("deadlines"))
    missed += event.name == "deadline missed";
  EXPECT_EQ(missed, 30);
  for (const PerfettoEvent& event : all.trace.on("front end")) {
    if (event.depth > 0 || event.type != PerfettoEvent::kBegin) continue;
    EXPECT_EQ(event.number("late"), 1) << event.name;
  }
}

TEST(Timeline, OccupationOfL1IsThePeakOfTheStage) {
  const std::vector<PerfettoEvent> l1 = shown(2).trace.on("L1, peak of the stage");
  ASSERT_EQ(l1.size(), 12u);
  EXPECT_EQ(l1[0].value, 777);
  EXPECT_EQ(l1[1].value, 0);
}

/// What the strips show of a colour: the sum of the areas of their rectangles [px²].
double area_of(const std::string& svg, const std::string& colour) {
  double sum = 0;
  const std::string path = "<path fill=\"" + colour + "\" d=\"";
  const std::regex sides(R"re(h([0-9.]+)v([0-9.]+)h-)re");
  for (std::size_t at = svg.find(path); at != std::string::npos; at = svg.find(path, at + 1)) {
    const std::string d = svg.substr(at, svg.find("/>", at) - at);
    for (std::sregex_iterator i(d.begin(), d.end(), sides), end; i != end; ++i)
      sum += std::stod((*i)[1]) * std::stod((*i)[2]);
  }
  return sum;
}

/// A run of so many frames, and its picture.
struct DrawnRun {
  explicit DrawnRun(int frames) {
    MixedSource source({.frames = frames, .iteration = 5'000}, 8, 3);
    draw(source);
  }
  DrawnRun(RunSource& source, const sim::ExternalMemoryConfig& external) {
    request.platform.config.controller.external = external;
    draw(source);
  }
  void draw(RunSource& source) {
    request.cores = 8;
    request.observer = &collector;
    run = simulate_source(request, source, [](const Progress&) {});
    svg = timeline_picture(collector.events(), run);
  }

  RunRequest request = testing::request_at(Hertz(370'000'000), std::nullopt);
  TimelineCollector collector{request.platform.config, 8};
  RunResult run;
  std::string svg;
};

TEST(TimelinePicture, AreasOfWorkAndWaitsAreThoseOfTheCycles) {
  const DrawnRun drawn(1);
  const auto& [request, collector, run, svg] = drawn;
  EXPECT_EQ(testing::xml_fault(svg), "");
  EXPECT_EQ(svg, timeline_picture(collector.events(), run));

  double work = 0, divider = 0;
  for (const StageEvents& stage : collector.events().frames.at(0).stages)
    for (const StepEvents& step : stage.steps)
      for (const CoreEvents& core : step.cores) {
        work += own_work(core.split);
        divider += core.split[sim::Mechanism::Divider];
      }
  ASSERT_GT(divider, 0);
  // A period of the camera, and 1 % more, is 880 px wide; a row is 19 px high.
  const double cycles_of_period = static_cast<double>(run.frame_period_ns) * 0.370;
  const double area_of_cycle = 880 * 19 / (1.01 * cycles_of_period);
  const double tolerance = 0.02 * work * area_of_cycle;
  EXPECT_NEAR(area_of(svg, "#2a7f62"), work * area_of_cycle, tolerance);
  EXPECT_NEAR(area_of(svg, "#be202e"), divider * area_of_cycle, tolerance);
  EXPECT_GT(area_of(svg, "#be202e"), 0);
}

TEST(TimelinePicture, HasARowOfExternalMemoryWhereDataPass) {
  ExternalSource source(5);
  const DrawnRun far(source, {1e-6, 64e6, Bytes(0), Bytes(1 << 20)});
  EXPECT_EQ(testing::xml_fault(far.svg), "");
  EXPECT_NE(far.svg.find(">external</text>"), std::string::npos);
  EXPECT_EQ(DrawnRun(1).svg.find(">external</text>"), std::string::npos);
}

TEST(TimelinePicture, OfTenFramesHasNoLabelsOnEachOtherAndAColourForEachStage) {
  const DrawnRun drawn(10);
  const auto& [request, collector, run, svg] = drawn;
  // On a line, from left to right: where each text ends if a letter is 6 px wide.
  std::map<std::string, std::map<double, double>> lines;
  const std::regex text(
      R"re(<text x="([0-9.]+)" y="([0-9.]+)" font-size="([0-9.]+)" text-anchor="([a-z]+)"[^>]*>([^<]*)<)re");
  for (std::sregex_iterator i(svg.begin(), svg.end(), text), end; i != end; ++i) {
    const double width = 6.0 * static_cast<double>((*i)[5].length());
    const double from = std::stod((*i)[1]) - ((*i)[4] == "end"      ? width
                                              : (*i)[4] == "middle" ? width / 2
                                                                    : 0);
    lines[(*i)[2]][from] = from + width;
  }
  for (const auto& [y, spans] : lines)
    for (auto span = spans.begin(); span != spans.end() && std::next(span) != spans.end(); ++span)
      EXPECT_LE(span->second, std::next(span)->first) << "y " << y;
  for (const FrameEvents& frame : collector.events().frames)
    for (const StageEvents& stage : frame.stages) {
      EXPECT_NE(svg.find(fmt::format(">{}</text>", stage.name)), std::string::npos) << stage.name;
    }
}

TEST(XmlFault, IsSeen) {
  const auto fault = [](const std::string& body) {
    return testing::xml_fault("<?xml version=\"1.0\"?>\n" + body);
  };
  EXPECT_EQ(fault("<a x=\"1\"><b/>&amp;</a>"), "");
  for (const char* broken : {"<a>", "<a></b>", "<a/><a/>", "<a>&</a>", "<a>&nbsp;</a>", "<a x=1/>",
                             "<a x=\"1\" x=\"2\"/>", "<a/>text", "<a>\x01</a>", ""})
    EXPECT_NE(fault(broken), "") << broken;
}

/// Of one frame without work, whose deadline is so far away.
std::string empty_picture(const std::string& profile, double period_ms) {
  TimelineEvents events{.timebase = sim::Timebase({}), .range = {}, .frames = {}, .iterations = {}};
  events.frames.emplace_back();
  RunResult run;
  run.profile = profile;
  run.frame_period_ns = std::llround(period_ms * 1e6);
  return timeline_picture(events, run);
}

TEST(TimelinePicture, IsWellFormedWhateverItsNamesHold) {
  const std::string svg =
      empty_picture("\"quoted\" 'q' <b> & \x01\xff\xc0\x80 10.5° – 🛸", 50);
  EXPECT_EQ(testing::xml_fault(svg), "") << svg;
  EXPECT_NE(
      svg.find(
          "&quot;quoted&quot; &#39;q&#39; &lt;b&gt; &amp; \\x01\\xff\\xc0\\x80 10.5° – 🛸"),
      std::string::npos)
      << svg;
  EXPECT_EQ(svg.find("-0.00"), std::string::npos) << svg;
}

TEST(TimelinePicture, TicksAreRoundAndHaveTheDecimalsOfTheirStep) {
  const std::regex label(R"re(font-size="11.00" text-anchor="middle"[^>]*>([0-9.]+)<)re");
  for (const double period : {1e-4, 0.07, 1.0, 3.3, 12.0, 50.0, 99.9, 120.0, 4.4e5, 1e7}) {
    const std::string svg = empty_picture("levio", period);
    std::vector<std::string> labels;
    for (std::sregex_iterator i(svg.begin(), svg.end(), label), end; i != end; ++i)
      labels.push_back((*i)[1]);
    ASSERT_GE(labels.size(), 4u) << period;
    EXPECT_LE(labels.size(), 12u) << period;
    const double step = std::stod(labels[1]);
    const double power = std::pow(10, std::floor(std::log10(step) + 1e-9));
    const double mantissa = std::round(step / power * 1e6) / 1e6;
    EXPECT_TRUE(mantissa == 1 || mantissa == 2 || mantissa == 5) << step;
    EXPECT_LT(std::stod(labels.back()), 1.01 * period * (1 + 1e-9)) << period;
    EXPECT_GT(std::stod(labels.back()) + step, 1.01 * period) << period;
    const std::size_t dot = labels[1].find('.');
    if (dot != std::string::npos) {
      EXPECT_NE(labels[1].back(), '0') << labels[1];
    }
    for (std::size_t k = 0; k < labels.size(); ++k) {
      EXPECT_NEAR(std::stod(labels[k]), static_cast<double>(k) * step, 1e-6 * step);
      EXPECT_EQ(labels[k].size() - std::min(labels[k].size(), labels[k].find('.')),
                labels[1].size() - std::min(labels[1].size(), dot))
          << labels[k];
    }
  }
}

TEST(Timeline, ARangeTakesItsFramesOnly) {
  const Shown some = shown(2, kMostBytesOfFrame, 8, {.frames = 9, .iteration = 5'000}, {},
                           traces::FrameRange{3, 5});
  std::vector<std::string> frames;
  for (const PerfettoEvent& event : some.trace.on("front end"))
    if (event.depth == 0 && event.type == PerfettoEvent::kBegin) frames.push_back(event.name);
  EXPECT_EQ(frames, (std::vector<std::string>{"frame 3", "frame 4"}));
  EXPECT_EQ(some.trace.on("camera").size(), 2u);
  const traces::FrameRange beyond{3, 10};
  expect_input_error(
      [&] { shown(2, kMostBytesOfFrame, 8, {.frames = 9, .iteration = 5'000}, {}, beyond); },
      {"--timeline-frames", "3:10", "9 frames"});
}

}  // namespace
}  // namespace leviosim::tools
