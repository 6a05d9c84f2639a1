// leviosim report and --report: refusals, same bytes, size, names that are HTML; and the page in a
// real browser, where there is one (Debian's chromium).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "sim/base/csv.h"
#include "tests/support/program_suite.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/json_reader.h"
#include "tools/app/record/record.h"
#include "tools/app/table/table_files.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::expect_refused;
using testing::ProgramResult;

constexpr const char* kBrowser = "/usr/bin/chromium";
/// A folder that may be called so.
constexpr const char* kEvilRun = "b<script>document.title='evil'<";

/// Two runs of a second of flight, on one chip and on another, for all tests.
class Report : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("report");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("a"),
                 "--record", "--quiet", "--report", path("a.html")});
    expect_done({"run", "--platform", "gap9", "-p", "cluster.fpu.units=1", "--data", path("flight"),
                 "--out", path(kEvilRun), "--quiet"});
  }

  /// What a page draws.
  static Json data_of(const std::string& page) {
    const std::string html = base::read_text_file(path(page));
    constexpr std::string_view kBegin = "id=\"data\">";
    const std::size_t begin = html.find(kBegin) + kBegin.size();
    return Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  }
};

TEST_F(Report, OfAFolderIsThatOfTheRunItself) {
  expect_done({"report", path("a"), "-o", path("again.html")});
  EXPECT_EQ(base::read_text_file(path("again.html")), base::read_text_file(path("a.html")));
}

TEST_F(Report, OfSeveralRunsHasTheirDifferencesAndIsSmall) {
  expect_done({"report", path("a"), path(kEvilRun), "-o", path("two.html")});
  const std::string page = base::read_text_file(path("two.html"));
  EXPECT_NE(page.find("\"leviosim comparison\""), std::string::npos);
  EXPECT_EQ(page.find("<script>document.title"), std::string::npos);
  EXPECT_LT(page.size(), 1'000'000u);
}

TEST_F(Report, RefusesBeforeAnythingIsWritten) {
  expect_refused(program({"report", "-o", path("x.html")}), {"RUN"});
  expect_refused(program({"report", path("a")}), {"--out"});
  expect_refused(program({"report", path("flight"), "-o", path("x.html")}), {"no run folder"});
  expect_refused(program({"report", path("a"), "-o", path("a.html")}), {"a.html", "--force"});
  EXPECT_FALSE(fs::exists(path("x.html")));
}

/// Without the engine, what has to be installed and built; with it, what the run lacks.
TEST_F(Report, ThatComputesRefusesBeforeAnythingIsWritten) {
  const ProgramResult refused =
      program({"report", path(kEvilRun), "--interactive", "-o", path("x.html")});
  if (refused.err.find("without the engine") != std::string::npos)
    expect_refused(refused, {"libc++-14-dev-wasm32", "tools/build.sh wasm leviosim"});
  else
    expect_refused(refused, {"work.trace", "--record"});
  EXPECT_FALSE(fs::exists(path("x.html")));
}

TEST_F(Report, RefusesAFolderThatLacksAColumn) {
  fs::copy(path("a"), path("old"));
  fs::remove(path("old/.leviosim-files"));
  std::string frames = base::read_text_file(path("old/frames.csv"));
  frames.replace(frames.find(",health,"), 8, ",other,");
  std::ofstream(path("old/frames.csv")) << frames;
  testing::expect_refused(program({"report", path("old"), "-o", path("old.html")}),
                          {"old/frames.csv", "has no column health"});
}

TEST_F(Report, OfACheckHasItsLimits) {
  const ProgramResult init = program({"budget", "init", path("a")});
  ASSERT_EQ(init.status, 0) << init.err;
  std::ofstream(path("budget.yaml")) << init.out;
  expect_done({"check", path("a"), "--budget", path("budget.yaml"), "--report", path("c.html")});
  EXPECT_NE(base::read_text_file(path("c.html")).find("\"leviosim check\""), std::string::npos);
}

/// Points that are done say nothing of a budget that they do not meet.
TEST_F(Report, OfASweepThatMissesItsBudgetSaysSo) {
  std::ofstream(path("missed.yaml")) << "base: { trace: a/work.trace }\npoints: { grid: { "
                                        "platform.cluster.fpu.units: [1, 4] } }\n";
  std::ofstream(path("small.yaml")) << "budgets:\n  - limits: [L1 peak <= 1 kB]\n";
  const ProgramResult missed =
      program({"sweep", path("missed.yaml"), "--out", path("missed"), "--quiet", "--cache",
               path("cache"), "--budget", path("small.yaml"), "--report", path("missed.html")});
  ASSERT_EQ(missed.status, 1) << missed.err;
  const std::string page = base::read_text_file(path("missed.html"));
  EXPECT_NE(page.find("NOT met by 2 of 2 points, first point 1"), std::string::npos);
  EXPECT_EQ(page.find("\"good\":true"), std::string::npos) << "a box in green";
}

/// Stages add up to the frame but for the call of the cluster and its answer; on one core, the
/// breakdown of a stage to its cycles.
TEST_F(Report, CyclesOfTheTablesAddUp) {
  const Json frames =
      columns_json(read_csv("frames.csv", base::read_text_file(path("a/frames.csv"))));
  for (std::size_t i = 0; i < frames["frame"].size(); ++i) {
    double sum = 0;
    for (const auto& [name, cells] : frames.items())
      if (name.rfind("cycles_", 0) == 0) sum += cells[i].get<double>();
    const double all = frames["parallel_cycles"][i];
    EXPECT_LE(sum, all);
    EXPECT_GT(sum, 0.99 * all);
  }
  const Json stages =
      columns_json(read_csv("stages.csv", base::read_text_file(path("a/stages.csv"))));
  for (std::size_t i = 0; i < stages["stage"].size(); ++i) {
    double sum = 0;
    for (const auto& [name, cells] : stages.items())
      if (name.rfind("single_", 0) == 0 && name != "single_cycles" &&
          name != "single_cycles_per_call")
        sum += cells[i].get<double>();
    EXPECT_NEAR(sum, stages["single_cycles"][i].get<double>(), 1) << stages["stage"][i];
  }
}

/// The mean square of the errors is that of the statistics.
TEST_F(Report, ErrorsOfTheTableAreThoseOfTheAte) {
  const Json errors =
      columns_json(read_csv("errors.csv", base::read_text_file(path("a/errors.csv"))));
  double squares = 0;
  for (const Json& error : errors["position_error_m"]) squares += std::pow(error.get<double>(), 2);
  const double count = static_cast<double>(errors["position_error_m"].size());
  const Json statistics = Json::parse(base::read_text_file(path("a/run.json")));
  const double ate = statistics.at("statistics").at("accuracy.ate.rmse").at(0).get<double>();
  EXPECT_NEAR(ate, std::sqrt(squares / count), 1e-8);
}

/// A page in frames of the browser's window, which may be narrower than a window can be. Each frame
/// reports what it looks like when it has been drawn.
class InBrowser : public Report {
 protected:
  void SetUp() override {
    if (!fs::exists(kBrowser)) GTEST_SKIP() << kBrowser << " is not installed (package chromium)";
  }

  static constexpr int kWidths[]{1280, 390};

  struct Seen {
    Json pages;       ///< what the page reported at each width, by width
    std::string log;  ///< of the browser, with the console's errors
  };

  static Seen open(const std::string& page, bool dark) {
    constexpr const char* kReport = R"(<script>
      const chartsOf = (axis) => [...document.querySelectorAll("canvas")].map((c) => Chart.getChart(c))
        .filter((c) => c && (!axis || c.data.datasets.some((d) => d.yAxisID === axis)));
      const light = (channels) => channels.reduce((sum, c, i) => sum + [0.2126, 0.7152, 0.0722][i] *
        (c <= 10 ? c / 3294.6 : ((c / 255 + 0.055) / 1.055) ** 2.4), 0.05);
      const channels = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map(Number);
      const contrast = (e) => ((a, b) => Math.max(a, b) / Math.min(a, b))(
        light(channels(getComputedStyle(e).color)), light(channels(getComputedStyle(e).backgroundColor)));
      const heard = () => ({
        nameless: [...document.querySelectorAll("th, button, summary")]
          .filter((e) => !e.textContent.trim() && !e.getAttribute("aria-label")).length,
        twice: [...document.querySelectorAll("section[aria-label], [role=region]")]
          .map((e) => e.getAttribute("aria-label")).filter((l, i, all) => all.indexOf(l) < i),
        skipped: [...document.querySelectorAll("h1, h2, h3")].map((h) => Number(h.tagName[1]))
          .filter((level, i, all) => i > 0 && level > all[i - 1] + 1).length,
        faint: [...document.querySelectorAll(".mark")].filter((e) => contrast(e) < 4.5)
          .map((e) => e.textContent)});
      addEventListener("load", () => {
        document.querySelectorAll("details").forEach((d) => { d.open = true; });
        setTimeout(report, 300);
      });
      const report = () => parent.postMessage({heard: heard(), width: innerWidth,
      overflow: document.documentElement.scrollWidth > innerWidth,
      requests: performance.getEntriesByType("resource").length,
      canvases: document.querySelectorAll("canvas").length,
      drawn: [...document.querySelectorAll("canvas")].filter((c) => Chart.getChart(c)).length,
      tables: document.querySelectorAll("figure details").length,
      verdict: document.querySelectorAll(".verdict, [aria-label=Runs]").length,
      colours: [...document.querySelectorAll("i")].every((i) => i.style.length > 0),
      marks: [...document.querySelectorAll(".verdict, [class^=status-]")]
        .map((e) => e.classList.contains("verdict") ? e.className : e.className + e.textContent),
      evil: document.title === "evil",
      unnamed: chartsOf("kind").reduce((sum, c) => sum + c.data.labels.length -
        c.data.datasets.filter((d) => d.yAxisID === "kind").flatMap((d) => d.data)
          .filter((v) => v).length, 0),
      untrusted: chartsOf("map").flatMap((c) => c.data.datasets.filter((d) => d.yAxisID === "map"))
        .flatMap((d) => d.data.map((v, i) => v ? `${i} ${d.label}` : null)).filter((v) => v),
      alike: [...chartsOf("").filter((c) => c.data.datasets.length > 1).flatMap((c) => c.data.datasets)
        .filter((d) => typeof d.backgroundColor === "string" && !d.silent && !d.legendLine)
        .reduce((names, d) => names.set(d.backgroundColor,
            (names.get(d.backgroundColor) || new Set()).add(d.label)), new Map())]
        .filter(([, names]) => names.size > 1).map(([colour, names]) => [colour, ...names].join(" ")),
      cut: [...document.querySelectorAll("section[id^=difference] .scroll.whole")]
        .some((s) => s.scrollWidth > s.clientWidth),
      ink: getComputedStyle(document.documentElement).getPropertyValue("--ink").trim()}, "*");
      </script></body>)";
    std::string html = base::read_text_file(path(page));
    html.replace(html.rfind("</body>"), 7, kReport);
    std::ofstream(path("reporting.html")) << html;
    std::string frames = R"(<body><script>const pages = {};
      addEventListener("message", ({data}) => {
        pages[data.width] = data;
        document.body.setAttribute("title", JSON.stringify(pages)); });</script>)";
    for (const int width : kWidths)
      frames += fmt::format(
          R"(<iframe src="reporting.html" style="border:0;width:{}px;height:900px"></iframe>)",
          width);
    std::ofstream(path("frame.html")) << frames;
    // Browsers reserve more addresses than tools/mutate.sh grants the tests.
    const std::string command = fmt::format(
        "ulimit -v unlimited; mkdir -p '{1}'; TMPDIR='{1}' timeout 240 {0} --headless=new "
        "--no-sandbox --disable-gpu "
        "--disable-dev-shm-usage "
        "--no-first-run --disable-background-networking --user-data-dir='{1}' "
        "--blink-settings=preferredColorScheme={2} --window-size=1400,1000 "
        "--enable-logging=stderr --virtual-time-budget=5000 --dump-dom 'file://{3}' >'{4}' 2>'{5}'",
        kBrowser, path("profile"), dark ? 0 : 1, path("frame.html"), path("dom.html"),
        path("log.txt"));
    EXPECT_EQ(std::system(command.c_str()), 0);
    const std::string dom = base::read_text_file(path("dom.html"));
    const std::size_t begin = dom.find("title=\"") + 7;
    std::string reported = dom.substr(begin, dom.find('"', begin) - begin);
    for (std::size_t at = 0; (at = reported.find("&quot;", at)) != std::string::npos;)
      reported.replace(at, 6, "\"");
    return {read_json("what the page reported", reported), base::read_text_file(path("log.txt"))};
  }

  /// @param verdicts  on the page, or tables of them
  static void expect_fine(const std::string& page, int verdicts = 1) {
    for (const bool dark : {false, true}) {
      const Seen seen = open(page, dark);
      EXPECT_EQ(seen.log.find("CONSOLE"), std::string::npos) << page << '\n' << seen.log;
      for (const int width : kWidths) {
        ASSERT_TRUE(seen.pages.contains(std::to_string(width))) << page << ", " << width << " px";
        const Json& drawn = seen.pages[std::to_string(width)];
        SCOPED_TRACE(
            fmt::format("{}, {} px, {}: {}", page, width, dark ? "dark" : "light", drawn.dump()));
        expect_drawn(drawn, verdicts, dark);
        if (width > 1000) {
          EXPECT_EQ(drawn["cut"], false) << "a table that has to be scrolled";
        }
      }
    }
  }
  static void expect_drawn(const Json& page, int verdicts, bool dark) {
    EXPECT_EQ(page["overflow"], false);
    EXPECT_EQ(page["requests"], 0);
    EXPECT_GT(page["canvases"], 0);
    EXPECT_EQ(page["drawn"], page["canvases"]);
    EXPECT_EQ(page["tables"], page["canvases"]);
    EXPECT_EQ(page["verdict"], verdicts);
    EXPECT_EQ(page["evil"], false);
    EXPECT_EQ(page["colours"], true);
    EXPECT_EQ(page["heard"], Json::parse(R"({"nameless":0,"twice":[],"skipped":0,"faint":[]})"))
        << "of those who listen, or see little";
    EXPECT_EQ(page["unnamed"], 0) << "frames without a colour that says where from";
    EXPECT_EQ(page["alike"], Json::array()) << "two names in one colour, on all charts";
    EXPECT_EQ(page["ink"], dark ? "#e4e9ef" : "#1b2430");
  }
};

TEST_F(InBrowser, APageOfARunIsDrawnWithoutErrorsRequestsOrOverflow) { expect_fine("a.html"); }

TEST_F(InBrowser, APageOfSeveralRunsIsToo) {
  expect_done({"report", path("a"), path(kEvilRun), "-o", path("both.html")});
  expect_fine("both.html", 2);
}

TEST_F(InBrowser, APageOfAnEvaluationIsToo) {
  const std::string truth = path("a/trajectory.tum");
  expect_done({"eval", truth, truth, "--also", truth, "--report", path("errors.html")});
  expect_fine("errors.html", 0);
}

/// Stages may be called as what every object of a script has.
TEST_F(InBrowser, APageOfStagesWithNamesOfScriptsIsToo) {
  fs::copy(path("a"), path("names"));
  fs::remove(path("names/.leviosim-files"));
  for (const char* name :
       {"frames.csv", "stages.csv", "cycles.csv", "memory.csv", "energy.csv", "run.json"}) {
    std::string text = base::read_text_file(path("names") + '/' + name);
    for (const auto& [stage, other] :
         {std::pair{"feature extraction", "constructor"},
          std::pair{"feature_extraction", "constructor"}, std::pair{"frame matching", "__proto__"},
          std::pair{"frame_matching", "proto"}, std::pair{",cores,", ",__proto__,"}})
      for (std::size_t at = 0; (at = text.find(stage, at)) != std::string::npos;)
        text.replace(at, std::string(stage).size(), other);
    std::ofstream(path("names") + '/' + name) << text;
  }
  expect_done({"report", path("names"), "-o", path("names.html")});
  expect_fine("names.html");
}

TEST_F(InBrowser, APageOfSensitivityIsToo) {
  expect_done({"sensitivity", "--data", path("flight"), "--frames", "0:4", "--quiet", "--report",
               path("sensitivity.html")});
  expect_fine("sensitivity.html");
}

/// One of a command on two chips names its columns by the change, and begins with the time.
TEST_F(InBrowser, APageOfAChangedChipIsToo) {
  expect_done({"compare", path("a"), "-p", "cluster.clock=240MHz", "--quiet", "--report",
               path("changed.html")});
  expect_fine("changed.html", 2);
  const Json data = data_of("changed.html");
  EXPECT_EQ(data["runs"][1]["name"], "cluster.clock=240MHz");
  EXPECT_EQ(data["comparisons"][0]["figures"][0]["name"], "frame time, mean");
  EXPECT_NE(data["comparisons"][0]["why"][0]["text"].get<std::string>().find("another clock +"),
            std::string::npos);
}

/// What is waited for is no part of the time that a frame takes; a chip that is too slow has both.
TEST_F(Report, TellsOwnTimeFromTheQueue) {
  expect_done({"replay", path("a"), "-p", "cluster.clock=100MHz", "--quiet", "--report",
               path("slow.html"), "--out", path("slow")});
  const Json run = data_of("slow.html")["runs"][0];
  EXPECT_NE(run["verdict"]["why"].get<std::string>().find(" of its own, after "),
            std::string::npos);
  const auto has = [&](const char* title) {
    return std::any_of(run["figures"].begin(), run["figures"].end(),
                       [&](const Json& figure) { return figure["title"] == title; });
  };
  EXPECT_TRUE(has("Frame time, worst"));
  EXPECT_TRUE(has("Latency, worst"));
}

TEST_F(InBrowser, APageOfABudgetThatIsNotMetIsToo) {
  std::ofstream(path("strict.yaml"))
      << "budgets:\n  - name: strict\n    limits:\n      - L1 peak <= 1 kB\n";
  const ProgramResult check = program(
      {"check", path("a"), "--budget", path("strict.yaml"), "--report", path("strict.html")});
  ASSERT_EQ(check.status, 1) << check.err;
  expect_fine("strict.html", 2);
}

TEST_F(InBrowser, LimitsThatOnlyWarnHaveTheirOwnMark) {
  std::ofstream(path("mild.yaml"))
      << "budgets:\n  - limits:\n      - { limit: L1 peak <= 1 kB, level: warn }\n";
  expect_done({"check", path("a"), "--budget", path("mild.yaml"), "--report", path("mild.html")});
  Json marks = open("mild.html", false).pages["1280"]["marks"];
  marks.erase(0);  // of the run
  EXPECT_EQ(marks, Json({"card verdict doubtful", "status-warn! ", "status-warn! warning"}));
}

TEST_F(InBrowser, APageOfATuningIsToo) {
  const ProgramResult tuned =
      program({"tune", "--data", path("flight"), "--clock", "200,370", "--fps", "10,20", "--seed",
               "1", "--quiet", "--cache", path("cache"), "--report", path("tune.html")});
  ASSERT_LE(tuned.status, 1) << tuned.err;  // 1: no clock meets the limits
  expect_fine("tune.html", 2);              // a box for each frame rate
}

TEST_F(InBrowser, APageOfASweepIsToo) {
  std::ofstream(path("plan.yaml")) << "base: { trace: a/work.trace }\npoints:\n  - grid:\n      "
                                      "platform.cluster.clock: [200MHz, "
                                      "370MHz]\n      platform.cluster.fpu.units: [1, 4]\n";
  expect_done({"sweep", path("plan.yaml"), "--out", path("sweep"), "--quiet", "--cache",
               path("cache"), "--report", path("sweep.html")});
  expect_fine("sweep.html");
}

/// One kernel became slower at the third of four commits, whose subject is HTML.
TEST_F(InBrowser, APageOfAHistoryIsToo) {
  std::ofstream(path("limits.yaml"))
      << "budgets:\n  - limits:\n      - { stage: frame matching, limit: cycles <= +1 % }\n";
  for (int n = 1; n <= 4; ++n)
    expect_done({"history", "add", path("a/work.trace"), "-p",
                 fmt::format("isa.ops.popcount.issue={}", n < 3 ? 1 : 2), "--commit",
                 fmt::format("c{}", n), "--branch", "main", "--time", fmt::format("{}", 1000 * n),
                 "--subject", "</script><script>document.title='evil'</script>", "--file",
                 path("history.jsonl"), "--quiet"});
  expect_done({"history", "page", "--file", path("history.jsonl"), "--budget", path("limits.yaml"),
               "--out", path("history.html")});
  expect_fine("history.html", 2);  // the answer, and what moved
}

/// As the odometry of `next` knows it.
TEST_F(InBrowser, FramesOfAMapThatIsNotTrustedAreMarked) {
  expect_done({"run", "--profile", "next", "--data", path("flight"), "--out", path("next"),
               "--quiet", "--report", path("next.html")});
  const Json frames =
      columns_json(read_csv("frames.csv", base::read_text_file(path("next/frames.csv"))));
  Json expected = Json::array();
  for (std::size_t i = 0; i < frames["health"].size(); ++i)
    if (frames["health"][i] == 1) expected.push_back(fmt::format("{} map: unreliable", i));
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(open("next.html", false).pages["1280"]["untrusted"], expected);
  expect_fine("next.html");
}

TEST_F(InBrowser, FramesThatInitialiseHaveAColour) {
  fs::copy(path("a"), path("initialising"));
  fs::remove(path("initialising/.leviosim-files"));
  std::string frames = base::read_text_file(path("a/frames.csv"));
  const std::string source =
      ',' + columns_json(read_csv("frames.csv", frames))["source"].back().get<std::string>() + ',';
  for (std::size_t at = frames.find(source); at != std::string::npos; at = frames.find(source))
    frames.replace(at, source.size(), ",initialising,");
  ASSERT_NE(frames.find(",initialising,"), std::string::npos);
  std::ofstream(path("initialising/frames.csv")) << frames;
  expect_done({"report", path("initialising"), "-o", path("initialising.html")});
  expect_fine("initialising.html");
}

}  // namespace
}  // namespace leviosim::tools
