// Every example of every --help works as it stands.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "tests/support/run_program.h"
#include "tests/support/scratch.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;
using testing::screen_fault;
using tests::Scratch;

/// The lines after a heading, without their indentation, to the next empty line.
std::vector<std::string> lines_below(const std::string& heading, const std::string& text) {
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line) && line != heading) {
  }
  std::vector<std::string> lines;
  while (std::getline(in, line) && line.rfind("  ", 0) == 0)
    lines.push_back(line.substr(line.find_first_not_of(' ')));
  return lines;
}

std::string help_of(const Scratch& folder, const std::string& command) {
  const ProgramResult help = run_program(folder.path(), {command, "--help"});
  EXPECT_EQ(help.status, 0) << command;
  return help.out;
}

/// Names of all commands: those that make what others read come first.
std::vector<std::string> commands_in_order(const Scratch& folder) {
  std::vector<std::string> names{"synth", "run"};
  const std::string help = run_program(folder.path(), {"--help"}).out;
  for (const char* group :
       {"Run the workload:", "Ask what if, and what would help:", "Guard the figures of a project:",
        "Trust: what the results rest on:"}) {
    const std::vector<std::string> lines = lines_below(group, help);
    EXPECT_GE(lines.size(), 5u) << group;
    for (const std::string& line : lines) {
      const std::string name = line.substr(0, line.find(' '));
      if (name != "synth" && name != "run") names.push_back(name);
    }
  }
  return names;
}

/// Not what goes into a file, nor a list or a document for programs.
bool is_for_people(const std::string& example) {
  // The demonstration's screen is a table of two verdicts (demo_command_test.cpp).
  for (const char* part : {">", "--list", "--json", "--format", "echo ", "leviosim demo"})
    if (example.find(part) != std::string::npos) return false;
  return true;
}

/// All in one folder, and what they print is a screen that ends with what came out.
TEST(Examples, OfEveryHelpWorkAsTheyStand) {
  const Scratch folder;
  fs::create_directory(folder / "bin");
  fs::create_directory(folder / "work");
  fs::create_symlink(leviosim::tests::program_path(), folder / "bin/leviosim");
  const std::vector<std::string> commands = commands_in_order(folder);
  EXPECT_GE(commands.size(), 19u);
  for (const std::string& command : commands) {
    const std::string help = help_of(folder, command);
    const std::vector<std::string> examples = lines_below("Examples:", help);
    EXPECT_FALSE(examples.empty()) << command << " --help has no examples:\n" << help;
    for (const std::string& example : examples) {
      const std::string line =
          "cd '" + (folder / "work").string() + "' && PATH='" + (folder / "bin").string() +
          "':$PATH XDG_CACHE_HOME='" + (folder / "cache").string() +
          "' && export PATH XDG_CACHE_HOME && " + "unset LINES COLUMNS && { " + example +
          "\n} >../screen.txt 2>../errors.txt || [ $? = 1 ]";  // a limit not met
      const int status = std::system(line.c_str());  // NOLINT: the command is leviosim's own
      const std::string errors = base::read_text_file(folder / "errors.txt");
      if (errors.find("built without the engine") != std::string::npos) continue;
      EXPECT_EQ(status, 0) << example << '\n' << errors;
      const std::string screen = base::read_text_file(folder / "screen.txt");
      if (is_for_people(example)) {
        EXPECT_EQ(screen_fault(screen), "") << example << '\n' << screen;
      }
    }
  }
}

TEST(Examples, AreShownByTheVerbHelpToo) {
  const Scratch folder;
  EXPECT_EQ(run_program(folder.path(), {"help", "tune"}).out, help_of(folder, "tune"));
  EXPECT_EQ(run_program(folder.path(), {"help"}).out, run_program(folder.path(), {"--help"}).out);
  testing::expect_refused(run_program(folder.path(), {"help", "tnue"}),
                          {"unknown command 'tnue'", "did you mean 'tune'"});
  testing::expect_refused(run_program(folder.path(), {"help", "tune", "run"}),
                          {"unexpected argument 'run'"});
}

}  // namespace
}  // namespace leviosim::tools
