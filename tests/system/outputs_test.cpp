// What commands leave, replace and refuse: nothing that leviosim did not write is lost.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "tests/support/run_program.h"
#include "tests/support/scratch.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using testing::run_program;
using tests::picture_of;
using tests::read_text;
using tests::Scratch;
using tests::write_text;
using traces::testing::AslFolder;
using Picture = std::map<std::string, std::string>;

class Outputs : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> run_words(const std::string& out,
                                     const std::vector<std::string>& further = {}) const {
    std::vector<std::string> words{"run",    "--native", "--data",  data_.root().string(),
                                   "--size", "32x24",    "--quiet", "--out",
                                   path(out)};
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }
  ProgramResult program(const std::vector<std::string>& words) const {
    return run_program(log_.path(), words);
  }
  void expect_done(const std::vector<std::string>& words) const {
    const ProgramResult result = program(words);
    EXPECT_EQ(result.status, 0) << result.err;
  }
  /// Refused, and nothing is changed, left or gone.
  void expect_kept(const std::vector<std::string>& words, const std::vector<std::string>& parts) {
    const Picture before = picture_of(folder_.path());
    expect_refused(program(words), parts);
    EXPECT_EQ(picture_of(folder_.path()), before);
  }
  void expect_kept_by_force(std::vector<std::string> words, const std::vector<std::string>& parts) {
    expect_kept(words, parts);
    words.emplace_back("--force");
    expect_kept(words, parts);
  }
  /// A run into `out` that stands still between its first file and its last.
  std::unique_ptr<Program> stopped_run(const std::string& out, bool force = false) const {
    const std::string hidden = "." + out + ".leviosim";
    for (int trial = 0; trial < 50; ++trial) {
      auto run = std::make_unique<Program>(
          log_.path(),
          run_words(out, force ? std::vector<std::string>{"--force"} : std::vector<std::string>{}));
      while (run->running() && !fs::exists(folder_ / hidden / "manifest.json")) {
      }
      run->send(SIGSTOP);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (run->running() && fs::exists(folder_ / hidden / "manifest.json")) return run;
      run->send(SIGCONT);
      run->wait();
      if (!force) fs::remove_all(folder_ / out);
    }
    ADD_FAILURE() << "no run was caught in the middle";
    return nullptr;
  }

  AslFolder data_;
  Scratch log_;
  Scratch folder_;
};

TEST_F(Outputs, ForceReplacesNoFolderOfOthers) {
  write_text(folder_ / "w/manifest.json", "{}");
  write_text(folder_ / "w/thesis.tex", "x");
  expect_kept_by_force(run_words("w"), {"--out", "manifest.json"});
  fs::remove(folder_ / "w/manifest.json");
  expect_kept_by_force(run_words("w"), {"thesis.tex"});
}

TEST_F(Outputs, ForceKeepsNotesInResults) {
  expect_done(run_words("w"));
  expect_kept(run_words("w"), {"exists and holds results", "--force"});
  write_text(folder_ / "w/notes.md", "x");
  expect_kept_by_force(run_words("w"), {"notes.md"});
  fs::remove(folder_ / "w/notes.md");
  expect_done(run_words("w", {"--force"}));
  write_text(folder_ / "w/frames.csv", "edited");
  expect_kept_by_force(run_words("w"), {"frames.csv", "changed since"});
}

TEST_F(Outputs, InputsInTheOutputStay) {
  expect_done(run_words("proj"));
  fs::copy(data_.root(), folder_ / "proj/data", fs::copy_options::recursive);
  std::vector<std::string> words = run_words("proj");
  words[3] = path("proj/data");
  expect_kept_by_force(words, {"proj/data"});
}

TEST_F(Outputs, ResultsThatAreReadStay) {
  expect_done(run_words("flown"));
  const std::string truth = data_.mav0("state_groundtruth_estimate0/data.csv").string();
  const std::vector<std::string> eval{"eval", path("flown"), truth, "--relative", "1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), eval.begin(), eval.end());
    return more;
  };
  expect_kept_by_force(with({"--json", path("flown/trajectory.tum")}), {"--json"});
  expect_kept_by_force(
      with({"--report", path("flown/stats.html"), "--json", path("flown/run.json")}),
      {"--json", "is a file of a run"});
  fs::copy(folder_ / "flown/trajectory.tum", folder_ / "est.tum");
  expect_kept_by_force({"eval", path("est.tum"), truth, "--json", path("est.tum")}, {"est.tum"});
}

TEST_F(Outputs, SingleFilesOfOthersStay) {
  const std::string truth = data_.mav0("state_groundtruth_estimate0/data.csv").string();
  const std::vector<std::string> eval{"eval", truth,    truth,         "--relative",
                                      "1",    "--json", path("f.json")};
  write_text(folder_ / "f.json", "mine");
  expect_kept_by_force(eval, {"--json", "exists"});
  write_text(folder_ / "f", "mine");
  expect_kept_by_force({"microbench", "--csv", path("f")}, {"--csv", "exists"});
  fs::remove(folder_ / "f.json");
  expect_done(eval);
  const std::string figures = read_text(folder_ / "f.json");
  expect_kept(eval, {"--force"});
  std::vector<std::string> forced = eval;
  forced.push_back("--force");
  expect_done(forced);
  EXPECT_EQ(read_text(folder_ / "f.json"), figures);
}

TEST_F(Outputs, SynthReplacesNoRecordings) {
  fs::copy(data_.root(), folder_ / "real", fs::copy_options::recursive);
  const std::vector<std::string> words{"synth", "--duration", "0.1", "--quiet", "--out"};
  const auto into = [&](const std::string& out) {
    std::vector<std::string> all = words;
    all.push_back(path(out));
    return all;
  };
  expect_kept_by_force(into("real"), {"real", "mav0"});
  expect_kept_by_force({"synth", "--motion", path("real"), "--out", path("real")}, {"is read"});
  expect_done(into("flight"));
  expect_kept(into("flight"), {"--force"});
  write_text(folder_ / "flight/notes", "x");
  expect_kept_by_force(into("flight"), {"notes"});
}

TEST_F(Outputs, AFolderMadeMeanwhileStaysAndTheResultsGoBeside) {
  for (const bool force : {false, true}) {
    const auto run = stopped_run("toc", force);
    ASSERT_TRUE(run);
    fs::create_directories(folder_ / "toc");
    write_text(folder_ / "toc/precious", "x");
    run->send(SIGCONT);
    const ProgramResult result = run->wait();
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("toc-2"), std::string::npos) << result.err;
    EXPECT_NE(result.out.find("results: " + path("toc-2")), std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("next: "), std::string::npos) << result.out;
    EXPECT_EQ(read_text(folder_ / "toc/precious"), "x");
    EXPECT_TRUE(fs::exists(folder_ / "toc-2/run.json"));
    fs::remove_all(folder_ / "toc");
    fs::remove_all(folder_ / "toc-2");
  }
}

TEST_F(Outputs, ASecondWriterIsRefusedAtOnce) {
  const auto first = stopped_run("toc");
  ASSERT_TRUE(first);
  const Scratch other_log;
  expect_refused(run_program(other_log.path(), run_words("toc")),
                 {"--out", "another leviosim is writing it", ".toc.leviosim"}, 75);
  first->send(SIGCONT);
  EXPECT_EQ(first->wait().status, 0);
  EXPECT_EQ(picture_of(folder_.path()).count("toc/run.json"), 1u);
}

TEST_F(Outputs, WhatAKillLeftIsGoneAfterTheNextRun) {
  const auto run = stopped_run("toc");
  ASSERT_TRUE(run);
  run->send(SIGKILL);
  run->wait();
  EXPECT_TRUE(fs::exists(folder_ / ".toc.leviosim"));
  expect_done(run_words("toc"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(Outputs, AFullDiskIsToldBeforeTheRun) {
  const std::string script = fmt::format(
      "trap '' XFSZ; ulimit -f 32; '{}' run --native --data '{}' --size 32x24 --out '{}' 2>'{}'",
      leviosim::tests::program_path(), data_.root().string(), path("toc"), path("err.txt"));
  EXPECT_EQ(WEXITSTATUS(std::system(script.c_str())), 2);  // NOLINT: the test's own
  const std::string err = read_text(folder_ / "err.txt");
  EXPECT_NE(err.find("--out " + path("toc") + ": "), std::string::npos) << err;
  EXPECT_NE(err.find("set aside: File too large"), std::string::npos) << err;
  EXPECT_EQ(picture_of(folder_.path()).size(), 1u);  // err.txt
}

TEST_F(Outputs, AnEmptyValueIsNotTheNextOption) {
  std::vector<std::string> words = run_words("x");
  words.erase(words.end() - 2, words.end());
  for (const std::vector<std::string>& out :
       {std::vector<std::string>{"--out=", "--quiet"}, {"--out", ""}, {"--out="}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), out.begin(), out.end());
    expect_kept(all, {"--out: is empty; expected"});
  }
  expect_kept({"eval", "--json=", "a", "b"}, {"--json: is empty"});
  expect_kept({"workload", ""}, {"argument '': is empty"});
}

TEST_F(Outputs, OutsThatCannotBeAreOneMessage) {
  fs::create_symlink("loop", folder_ / "loop");
  fs::create_symlink("nowhere", folder_ / "dangling");
  write_text(folder_ / "file", "x");
  expect_kept(run_words("loop"), {"--out", "symbolic links"});
  expect_kept(run_words("dangling"), {"--out", "leads nowhere"});
  expect_kept(run_words("file"), {"--out", "is a file"});
  expect_kept(run_words("file/x"), {"--out", "Not a directory"});
  expect_kept(run_words(std::string(300, 'x')), {"--out", "name too long"});
}

/// Sets variables of the environment until the end of its life; nothing: not set.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::optional<std::string>>& values) {
    for (const auto& [name, value] : values) {
      const char* const before = std::getenv(name.c_str());
      before_[name] = before == nullptr ? std::nullopt : std::optional<std::string>(before);
      set(name, value);
    }
  }
  ~Environment() {
    for (const auto& [name, value] : before_) set(name, value);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static void set(const std::string& name, const std::optional<std::string>& value) {
    if (value)
      ::setenv(name.c_str(), value->c_str(), 1);
    else
      ::unsetenv(name.c_str());
  }
  std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(Outputs, TheCacheOfNobodyElseIsUsed) {
  const Environment bare(
      {{"HOME", std::nullopt}, {"XDG_CACHE_HOME", std::nullopt}, {"TMPDIR", folder_.path()}});
  const std::string cache = fmt::format("leviosim-{}", ::geteuid());
  const std::vector<std::string> words{
      "ablate",    "--data", data_.root().string(), "--size", "32x24",   "--seed", "1",
      "--profile", "levio",  "--relative",          "1",      "--quiet", "--out",  path("out")};
  fs::create_directory(folder_ / "elsewhere");
  fs::create_symlink("elsewhere", folder_ / cache);
  expect_kept(words, {cache, "only you can use", "XDG_CACHE_HOME"});
  fs::remove(folder_ / cache);
  fs::create_directory(folder_ / cache);
  fs::permissions(folder_ / cache, fs::perms::all);
  expect_kept(words, {cache, "only you can use", "XDG_CACHE_HOME"});
  fs::remove(folder_ / cache);
  expect_done(words);
  EXPECT_EQ(fs::status(folder_ / cache).permissions(), fs::perms::owner_all);
  EXPECT_TRUE(fs::exists(folder_ / cache / "outcomes"));
  if (::geteuid() != 0) return;  // nobody else gives folders away
  fs::create_directories(folder_ / "home/.cache/leviosim");
  ASSERT_EQ(::chown((folder_ / "home/.cache/leviosim").c_str(), 12345, 12345), 0);
  const Environment home({{"HOME", path("home")}});
  std::vector<std::string> again = words;
  again.back() = path("out2");
  expect_kept(again, {".cache/leviosim", "another user", "XDG_CACHE_HOME"});
}

TEST_F(Outputs, SweepsOnlyAddToWhatSweepsWrote) {
  write_text(folder_ / "plan.yaml",
             fmt::format("base: {{ data: '{}', platform: gap9, size: 32x24 }}\n"
                         "points: {{ grid: {{ seed: [1, 2] }} }}\n",
                         data_.root().string()));
  const auto sweep = [&](const std::string& out) {
    return std::vector<std::string>{"sweep",   path("plan.yaml"),         "--quiet",
                                    "--cache", (log_ / "cache").string(), "--out",
                                    path(out)};
  };
  expect_done(sweep("w"));
  const std::string table = read_text(folder_ / "w/sweep.csv");
  std::vector<std::string> anew = sweep("w");
  anew.push_back("--force");
  expect_done(anew);
  EXPECT_EQ(read_text(folder_ / "w/sweep.csv"), table);
  write_text(folder_ / "w/notes", "x");
  expect_kept_by_force(sweep("w"), {"something other than a sweep: notes"});
  fs::remove(folder_ / "w/notes");
  write_text(folder_ / "w/sweep.csv", table + "edited");
  expect_kept_by_force(sweep("w"), {"sweep.csv", "changed since"});
  expect_kept_by_force({"sweep", "--merge", path("w"), path("w")}, {"--merge", "is read"});
  for (const char* text : {"", "no sweep", "{\"sweep\":\"living room\"}\n", "{\"sweep\":"}) {
    write_text(folder_ / "v/points.jsonl", text);
    expect_kept_by_force(sweep("v"), {"points.jsonl"});
  }
  write_text(folder_ / "u/sweep.sqlite", "mine");
  expect_kept_by_force(sweep("u"), {"sweep.sqlite", "earlier leviosim", "new folder"});
  write_text(folder_ / "t/sweep.sqlite-journal", "x");
  expect_kept_by_force(sweep("t"), {"sweep.sqlite-journal"});
}

}  // namespace
}  // namespace leviosim::tools
