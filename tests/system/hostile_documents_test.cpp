// Documents that a stranger wrote: nested without end, naming a thing a million times, or with
// texts that mean something where they are printed.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <thread>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using tests::read_text;
using tests::write_text;

std::string repeated(const std::string& piece, std::size_t times) {
  std::string text;
  text.reserve(piece.size() * times);
  for (std::size_t i = 0; i < times; ++i) text += piece;
  return text;
}

class HostileDocuments : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile-documents");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.3, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--record", "--out",
                 path("run"), "--quiet"});
    const ProgramResult baseline = program({"budget", "record", path("run")});
    ASSERT_EQ(baseline.status, 0) << baseline.err;
    write_text(path("baseline.json"), baseline.out);
    write_text(path("budget.yaml"),
               "budgets: [{ limits: [{ stage: frame matching, limit: cycles <= +1 % }] }]\n");
    expect_done({"history", "add", path("run"), "--file", path("history.jsonl"), "--commit", "c1",
                 "--branch", "main", "--time", "1", "--subject", "s"});
  }
  static ProgramResult limited(const std::vector<std::string>& words) {
    return Program(folder_->path(), words, {.cpu_seconds = 10, .data_bytes = 600'000'000}).wait();
  }
  static std::vector<std::vector<std::string>> readers_of_run(const std::string& run) {
    return {{"compare", path(run), path("run"), "--quiet"},
            {"check", path(run), "--budget", path("budget.yaml"), "--baseline", path("run")},
            {"report", path(run), "--out", path("page.html")}};
  }
};

TEST_F(HostileDocuments, DepthIsBounded) {
  const std::vector<std::string> deep{
      repeated("[", 60'000), "{\"a\":" + repeated("[", 60'000) + repeated("]", 60'000) + "}",
      repeated("{\"a\":", 200'000) + "1" + repeated("}", 200'000), repeated("[{\"a\":", 50'000),
      "{\"a\":" + repeated("[", 65) + repeated("]", 65) + "}"};
  for (const std::string& text : deep) {
    for (const char* file : {"run.json"}) {
      fs::remove_all(path("copy"));
      fs::copy(path("run"), path("copy"), fs::copy_options::recursive);
      fs::remove(path("copy/.leviosim-files"));
      write_text(path("copy/") + file, text);
      for (const auto& words : readers_of_run("copy")) expect_refused(limited(words), {file});
    }
    write_text(path("deep.json"), text);
    expect_refused(limited({"check", path("run"), "--budget", path("budget.yaml"), "--baseline",
                            path("deep.json")}),
                   {"deep.json"});
    write_text(path("deep.jsonl"), read_text(path("history.jsonl")) +
                                       "{\"run\":\"c2\",\"time\":2,\"a\":" + text + "}\n");
    expect_refused(limited({"history", "show", "--file", path("deep.jsonl")}), {"deep.jsonl"});
  }
}

TEST_F(HostileDocuments, LinesOfHistoriesAreBounded) {
  const std::string history = read_text(path("history.jsonl"));
  const std::size_t at = history.find("\"stages\":[") + 10;
  const std::string stage = R"({"name":"s","key":"s","controller":false})";
  for (const std::size_t times :
       {std::size_t{2000}, std::size_t{100'000}, std::size_t{1'000'000}}) {
    std::string many = history;
    many.insert(at, repeated(stage + ',', times));
    write_text(path("many.jsonl"), many);
    expect_refused(limited({"history", "show", "--file", path("many.jsonl")}), {"many.jsonl"});
  }
  write_text(path("many.jsonl"), history + repeated("[", 20'000'000) + "\n");
  expect_refused(limited({"history", "show", "--file", path("many.jsonl")}), {"many.jsonl"});
}

/// Bytes that printable() escapes are escapes of JSON in JSON.
TEST_F(HostileDocuments, JsonIsJsonWhateverTextsSay) {
  const std::vector<std::string> texts{"\u2028", "\u2029", "\u202e",    "\u2066",
                                       "\u2069", "\u009b", "\u0085",    "\x7f",
                                       "\ufffe", "\xff",   "::error::x"};
  for (const std::string& text : texts) {
    const std::string budget = path("b" + text + ".yaml");
    write_text(budget,
               "budgets: [{ limits: [{ stage: frame matching, limit: cycles <= +1 % }] }]\n");
    const std::string copy = path("r" + text);
    fs::copy(path("run"), copy, fs::copy_options::recursive);
    for (const auto& words : std::vector<std::vector<std::string>>{
             {"compare", copy, path("run"), "--json", "--quiet"},
             {"check", copy, "--budget", budget, "--baseline", path("run"), "--json"}}) {
      const ProgramResult result = limited(words);
      EXPECT_LE(result.status, 1) << result.err;
      EXPECT_TRUE(nlohmann::json::accept(result.out)) << result.out.substr(0, 400);
    }
    fs::remove_all(copy);
  }
}

TEST_F(HostileDocuments, MarkdownOfOthersIsText) {
  const std::string copy =
      path("<img src=x onerror=1> [a](http:evil) @team ![b](c) https:  `d` **e** ~f~ &lt;");
  fs::copy(path("run"), copy, fs::copy_options::recursive);
  fs::remove(copy + "/.leviosim-files");
  for (const char* file : {"run.json", "stages.csv", "cycles.csv"}) {
    if (!fs::exists(copy + '/' + file)) continue;
    std::string text = read_text(copy + '/' + file);
    for (std::size_t k; (k = text.find("frame matching")) != std::string::npos;)
      text.replace(k, 14, "<b>[x](y) @all");
    write_text(copy + '/' + file, text);
  }
  const ProgramResult compared =
      limited({"compare", copy, path("run"), "--format", "markdown", "--quiet"});
  EXPECT_LE(compared.status, 1) << compared.err;
  const ProgramResult checked =
      limited({"check", copy, "--budget", path("budget.yaml"), "--baseline", path("run"),
               "--markdown", path("comment.md")});
  const std::string comment =
      fs::exists(path("comment.md")) ? read_text(path("comment.md")) : std::string();
  for (const std::string& text : {compared.out, comment}) {
    for (const char* live :
         {"<img", "<b>", "[a](", "[b](", "[x](", "@team", "@all", "`d`", "**e**"})
      EXPECT_EQ(text.find(live), std::string::npos) << live << " in\n" << text;
  }
  EXPECT_NE(compared.out.find("&lt;img"), std::string::npos) << compared.out;
  fs::remove_all(copy);
}

TEST_F(HostileDocuments, ChildrenGetTheSignals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    for (const bool bisects : {true, false}) {
      fs::remove(path("told"));
      fs::remove(path("begun"));
      write_text(path("child"), fmt::format("#!/bin/sh\ntrap 'echo told >{}; exit 3' INT TERM HUP\n"
                                            "echo >{}\nfor i in $(seq 300); do sleep 0.1; done\n",
                                            path("told"), path("begun")));
      fs::permissions(path("child"), fs::perms::owner_all);
      std::vector<std::string> words{"compare", "--programs", path("child"), path("child"),
                                     "--",      "--data",     path("flight")};
      if (bisects)
        words = {"bisect",     path("run"),           "--budget", path("budget.yaml"),
                 "--baseline", path("baseline.json"), "--",       path("child")};
      Program program(folder_->path(), words);
      for (int tries = 0; tries < 1000 && !fs::exists(path("begun")); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      program.send(signal);
      const ProgramResult result = program.wait();
      EXPECT_EQ(read_text(path("told")), "told\n") << words[0] << ' ' << signal;
      EXPECT_TRUE(result.status == 128 + signal || bisects) << result.status;
    }
  }
}

TEST_F(HostileDocuments, SmallOnesAreRefusedSoon) {
  expect_refused(limited({"platforms", "new", path("a\nb")}), {"characters"});
  expect_refused(limited({"platforms", "new", path("a\x1b[2Jb")}), {"characters"});
  expect_refused(limited({"whatif", "no-such-chip"}), {"no-such-chip"});
  for (const char* value : {"nan", "inf", "-inf", "nanMHz"})
    expect_refused(limited({"whatif", path("run"), fmt::format("cluster.clock={}", value)}),
                   {"finite"});
  const std::string stages = read_text(path("run/stages.csv"));
  for (const char* file : {"stages.csv", "frames.csv", "manifest.json"})
    EXPECT_EQ(limited({"sensitivity", path("run"), "--csv", path("run/") + file, "--force"}).status,
              2);
  EXPECT_EQ(read_text(path("run/stages.csv")), stages);
}

}  // namespace
}  // namespace leviosim::tools
