// The Debian packages of this build are unpacked, and a project of its own uses what they hold in
// an empty folder, as the page tests/examples/outside/README.md says.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdlib>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/scratch.h"
#include "tests/support/text_lines.h"
#include "tools/app/record/statistic_list.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using tests::read_text;
using tests::Scratch;

/// What the page wants typed: its blocks of shell lines, to use the package and to measure a
/// kernel.
std::vector<std::string> blocks_of_page() {
  const std::string page = read_text(tests::source_folder() / "tests/examples/outside/README.md");
  const std::string begin = "\n```sh\n";
  std::vector<std::string> blocks;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    blocks.push_back(page.substr(at, page.find("```", at) - at));
  }
  return blocks;
}

/// An entry of this build's cache: "CMAKE_CXX_FLAGS".
std::string entry_of_cache(const std::string& name) {
  const std::string cache = '\n' + read_text(tests::build_folder() / "CMakeCache.txt");
  const std::size_t at = cache.find('\n' + name + ':');
  if (at == std::string::npos) return {};
  const std::size_t equals = cache.find('=', at);
  return cache.substr(equals + 1, cache.find('\n', equals) - equals - 1);
}

class Installed : public ::testing::Test {
 protected:
  /// @returns the exit status; what was printed is in log.txt
  int sh(const std::string& lines) {
    tests::write_text(folder_ / "lines.sh", lines);
    const std::string home = folder_.path().string();
    const std::string line =
        "cd '" + home + "' && HOME='" + home + "' XDG_CACHE_HOME='" + home + "/cache' CXX='" +
        entry_of_cache("CMAKE_CXX_COMPILER") + "' CXXFLAGS='" +
        entry_of_cache("CMAKE_CXX_FLAGS") +  // sanitizers, for what links the library
        "' bash -euo pipefail lines.sh >log.txt 2>&1";
    const int status = std::system(line.c_str());  // NOLINT: the lines are the page's
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  std::string log() const { return read_text(folder_ / "log.txt"); }
  /// What the packages hold, with the example that is part of them.
  void unpack() {
    ASSERT_EQ(
        sh("cpack -G DEB --config '" + (tests::build_folder() / "CPackConfig.cmake").string() +
           "' -B packages -D CPACK_DEBIAN_COMPRESSION_TYPE=none "
           "-D CPACK_DEBIAN_PACKAGE_SHLIBDEPS=OFF\n"
           "for package in packages/*.deb; do dpkg-deb -x \"$package\" packages/root; done\n"
           "mv packages/root/usr leviosim\n"
           "cp -r leviosim/share/doc/libleviosim-dev/examples/outside ."),
        0)
        << log();
  }
  bool has(const char* file) const { return fs::exists(folder_ / file); }
  /// Of the stage's cycles on one core, those of code that was not measured.
  double unmeasured_in(const char* run) const {
    const Json stats = Json::parse(read_text(folder_ / run / "run.json"));
    return stats.at("statistics").at("stages.exposure.unmeasured").at(0).get<double>();
  }

  Scratch folder_;
};

TEST_F(Installed, AProjectOfItsOwnHasEveryCommand) {
  if (sh("command -v cpack dpkg-deb dpkg-shlibdeps") != 0)
    GTEST_SKIP() << "cpack, dpkg-deb or dpkg-shlibdeps is missing; apt-get install cmake dpkg-dev";
  unpack();
  const std::vector<std::string> blocks = blocks_of_page();
  ASSERT_EQ(blocks.size(), 2u);
  // As a project is before its kernel was measured.
  const std::string code = read_text(folder_ / "outside/exposure_code.h");
  tests::write_text(folder_ / "outside/exposure_code.h",
                    code.substr(0, code.find("  return")) + "  return {};\n}\n");
  ASSERT_EQ(sh(blocks[0]), 0) << log();
  for (const char* file : {"recorded/work.trace", "replayed/stages.csv", "on-mychip/stages.csv",
                           "points/sweep.csv", "budgets.yaml", "page.html", "frame.svg"})
    EXPECT_TRUE(has(file)) << file << '\n' << log();
  EXPECT_NE(log().find("workload.row_step"), std::string::npos);
  EXPECT_EQ(tests::lines_of(read_text(folder_ / "outside/mychip.yaml")).size(), 5u);
  EXPECT_NE(read_text(folder_ / "recorded/stages.csv").find("exposure"), std::string::npos);
  for (const std::string program :
       {"leviosim-measure", "leviosim-check-counting", "leviosim-bag-to-asl"}) {
    EXPECT_EQ(sh("leviosim/bin/" + program + " --help"), 0) << log();
    EXPECT_NE(log().find("usage: " + program + " "), std::string::npos) << log();
    EXPECT_EQ(log().find(".py"), std::string::npos) << log();
    EXPECT_EQ(sh("leviosim/bin/" + program + " none none --list"), 2);
    EXPECT_EQ(log().rfind(program + ": ", 0), 0u) << log();
  }
  // A recorded run needs no program of its own to be timed.
  EXPECT_EQ(sh("leviosim/bin/leviosim replay recorded --out by-leviosim && cmp recorded/stages.csv "
               "by-leviosim/stages.csv"),
            0)
      << log();
  EXPECT_EQ(sh("build/exposure run --data flight -p workload.window=4 --out refused"), 2);
  EXPECT_NE(log().find("'exposure' has no such parameter"), std::string::npos) << log();
  EXPECT_EQ(sh("build/exposure run --data flight --profile levio -p workload.row_step=2 --out no"),
            2);
  EXPECT_NE(log().find("'levio' has no such parameter"), std::string::npos) << log();
  EXPECT_FALSE(has("refused") || has("no"));

  EXPECT_GT(unmeasured_in("recorded"), 0.9);
  const int measured = sh("export PATH=$PWD/build:$HOME/leviosim/bin:$PATH\n" + blocks[1]);
  if (log().find("apt-get install") != std::string::npos) GTEST_SKIP() << log();
  ASSERT_EQ(measured, 0) << log();
  EXPECT_EQ(read_text(folder_ / "outside/exposure_code.h"), code);
  EXPECT_LT(unmeasured_in("measured"), 0.01);
}

/// The build's own scripts, as they are in a folder in which nothing was built.
TEST_F(Installed, WhatIsNotBuiltIsNamedWithWhatBuildsIt) {
  const std::string script = read_text(tests::build_folder() / "cmake_install.cmake");
  for (const auto& [component, file, targets] :
       {std::array{"program", "/leviosim\"", "leviosim"},
        std::array{"library", "/library/libleviosim.a\"", "leviosim leviosim_library"}}) {
    std::string unbuilt = script;
    const std::size_t at = unbuilt.find(file, unbuilt.find("NOT EXISTS"));
    ASSERT_NE(at, std::string::npos) << file;
    unbuilt.insert(at + std::string_view(file).size() - 1, "-that-is-not-there");
    tests::write_text(folder_ / "install.cmake", unbuilt);
    EXPECT_EQ(sh(std::string("cmake -DCMAKE_INSTALL_PREFIX=into -DCMAKE_INSTALL_COMPONENT=") +
                 component + " -P install.cmake"),
              1);
    EXPECT_NE(log().find("is not built"), std::string::npos) << log();
    EXPECT_NE(log().find("  cmake --build " + tests::build_folder().string() + " --target " +
                         targets + '\n'),
              std::string::npos)
        << log();
    EXPECT_FALSE(has("into"));
  }
}

TEST_F(Installed, ThePagesForPeopleAndShellsNameEveryCommandAndOption) {
  ASSERT_EQ(sh("cmake --install '" + tests::build_folder().string() +
               "' --component program --prefix leviosim && leviosim/bin/leviosim run --help"),
            0)
      << log();
  const std::string share = "leviosim/share/";
  for (const char* file :
       {"man/man1/leviosim.1", "bash-completion/completions/leviosim",
        "zsh/vendor-completions/_leviosim", "fish/vendor_completions.d/leviosim.fish"}) {
    const std::string text = read_text(folder_ / (share + file));
    for (const char* word : {"replay", "whatif", "deadline", "record"})
      EXPECT_NE(text.find(word), std::string::npos) << file << " lacks " << word;
  }
  // The shell completes what begins with "re" and an option of a command.
  ASSERT_EQ(
      sh("source leviosim/share/bash-completion/completions/leviosim\n"
         "COMP_WORDS=(leviosim re) COMP_CWORD=1; _leviosim; echo \"${COMPREPLY[*]}\"\n"
         "COMP_WORDS=(leviosim run --dead) COMP_CWORD=2; _leviosim; echo \"${COMPREPLY[*]}\""),
      0)
      << log();
  EXPECT_EQ(log(), "replay report recording\n--deadline\n");
  EXPECT_EQ(sh("leviosim/bin/leviosim help --as latex"), 2);
  EXPECT_NE(log().find("expected man, bash, zsh, fish"), std::string::npos) << log();
}

}  // namespace
}  // namespace leviosim::tools
