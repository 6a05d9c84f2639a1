// Includes go where the build says that they may: every room, which is a folder with a library and
// the folders below it that are no rooms, includes its own headers and those of the rooms that its
// line leviosim_add_room(...) names. The lines name no more than is used, and make no circle.
// Headers of other projects are not looked at.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/text_lines.h"

namespace leviosim::tests {
namespace {

namespace fs = std::filesystem;

/// Room → rooms that it may include, or that its files include.
using Arrows = std::map<std::string, std::set<std::string>>;

/// @param lines  "room: names"; names without a slash, with "::" or with a leading slash are
///               libraries of others
Arrows parse_rooms(std::istream& lines) {
  Arrows rooms;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string room;
    words >> room;
    if (room.empty()) continue;
    room.pop_back();
    rooms[room];
    for (std::string word; words >> word;)
      if (word.front() != '/' && word.find('/') != std::string::npos) rooms[room].insert(word);
  }
  return rooms;
}

/// Folders, relative to the project, of the headers that a source includes.
std::set<std::string> folders_included(std::istream& source) {
  static const std::regex include(R"re(^\s*#include\s+"([^"]+)/[^/"]+")re");
  std::set<std::string> folders;
  for (std::string line; std::getline(source, line);)
    if (std::smatch found; std::regex_search(line, found, include)) folders.insert(found[1]);
  return folders;
}

/// The room that a folder is, or lies in; the folder itself if there is none.
std::string room_of(const std::string& folder, const Arrows& rooms) {
  for (fs::path at = folder; !at.empty(); at = at.parent_path())
    if (rooms.count(at.string()) != 0) return at.string();
  return folder;
}

/// What the sources of the rooms include; faults name sources that are in no room.
Arrows used_arrows(const fs::path& project, const Arrows& rooms, std::vector<std::string>& faults) {
  Arrows used;
  for (const char* part : {"sim", "workload", "platform_models", "traces", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(project / part)) {
      const std::string kind = entry.path().extension().string();
      if (kind != ".h" && kind != ".cpp") continue;
      const fs::path file = fs::relative(entry.path(), project);
      const std::string folder = file.parent_path().string();
      // What runs on the measured processor is built by a script; the others are the program, what
      // others see of its library, and the Python module.
      if (folder.rfind("tools/rv32", 0) == 0 || folder == "tools" || folder == "tools/python" ||
          folder.rfind("tools/wasm", 0) == 0)
        continue;
      const std::string room = room_of(folder, rooms);
      if (rooms.count(room) == 0) {
        faults.push_back(file.string() + " is in no room");
        continue;
      }
      std::ifstream source(entry.path());
      for (const std::string& other : folders_included(source))
        if (room_of(other, rooms) != room) used[room].insert(room_of(other, rooms));
    }
  return used;
}

std::vector<std::string> against_the_arrows(const Arrows& allowed, const Arrows& used) {
  std::vector<std::string> faults;
  for (const auto& [room, others] : used)
    for (const std::string& other : others)
      if (allowed.at(room).count(other) == 0)
        faults.push_back(room + " includes " + other + ", which its line does not name");
  return faults;
}

std::vector<std::string> named_in_vain(const Arrows& allowed, const Arrows& used) {
  std::vector<std::string> faults;
  for (const auto& [room, others] : allowed)
    for (const std::string& other : others)
      if (used.count(room) == 0 || used.at(room).count(other) == 0)
        faults.push_back(room + " names " + other + ", but includes nothing of it");
  return faults;
}

/// A circle as "a → b → a"; empty if there is none.
std::string circle(const Arrows& arrows) {
  std::vector<std::string> path;
  std::set<std::string> finished;
  std::string found;
  const std::function<void(const std::string&)> visit = [&](const std::string& room) {
    if (!found.empty() || finished.count(room) != 0) return;
    const auto again = std::find(path.begin(), path.end(), room);
    if (again != path.end()) {
      for (auto it = again; it != path.end(); ++it) found += *it + " → ";
      found += room;
      return;
    }
    path.push_back(room);
    if (const auto it = arrows.find(room); it != arrows.end())
      for (const std::string& other : it->second) visit(other);
    path.pop_back();
    finished.insert(room);
  };
  for (const auto& [room, others] : arrows) visit(room);
  return found;
}

/// Which parts of the tree a part may name at all, whatever its rooms say.
const std::map<std::string, std::set<std::string>> kPartMayName{
    {"sim", {"sim"}},
    {"workload", {"sim/base", "sim/work", "workload"}},
    {"platform_models", {"sim", "platform_models"}},
    {"traces", {"sim/base", "sim/outputs", "sim/work", "traces"}},
    {"tools/app", {"sim", "workload", "platform_models", "traces", "tools/app"}},
    {"tools/commands", {"sim", "workload", "platform_models", "traces", "tools/app"}},
};

bool is_within(const std::string& room, const std::string& folder) {
  return room == folder || room.rfind(folder + "/", 0) == 0;
}

std::vector<std::string> against_the_order_of_parts(const Arrows& arrows) {
  std::vector<std::string> faults;
  for (const auto& [room, others] : arrows)
    for (const auto& [part, allowed] : kPartMayName) {
      if (!is_within(room, part)) continue;
      for (const std::string& other : others)
        if (std::none_of(allowed.begin(), allowed.end(),
                         [&](const std::string& folder) { return is_within(other, folder); }))
          faults.push_back(room + " names " + other + "; " + part + " may not");
    }
  return faults;
}

class Includes : public ::testing::Test {
 protected:
  Arrows allowed_ = [] {
    std::ifstream file(rooms_file());
    return parse_rooms(file);
  }();
  std::vector<std::string> strays_;
  Arrows used_ = used_arrows(source_folder(), allowed_, strays_);
};

TEST_F(Includes, EverySourceIsInARoom) {
  EXPECT_GT(allowed_.size(), 30u);
  EXPECT_EQ(joined(strays_), "");
}

TEST_F(Includes, GoNowhereButWhereTheBuildSays) {
  EXPECT_EQ(joined(against_the_arrows(allowed_, used_)), "");
}

TEST_F(Includes, AreThereForEveryArrow) { EXPECT_EQ(joined(named_in_vain(allowed_, used_)), ""); }

TEST_F(Includes, MakeNoCircle) { EXPECT_EQ(circle(allowed_), ""); }

TEST_F(Includes, KeepTheOrderOfTheParts) {
  EXPECT_EQ(joined(against_the_order_of_parts(allowed_)), "");
}

// What the tests above rest on does notice faults.
TEST(IncludeRules, FindWhatIsAgainstThem) {
  std::istringstream lines("sim/a: sim/b fmt::fmt /usr/lib/x.so\nsim/b: sim/c\nsim/c: sim/a\n");
  const Arrows rooms = parse_rooms(lines);
  EXPECT_EQ(rooms.at("sim/a"), std::set<std::string>{"sim/b"});
  EXPECT_EQ(circle(rooms), "sim/a → sim/b → sim/c → sim/a");
  EXPECT_EQ(circle({{"a", {"b", "c"}}, {"b", {"c"}}}), "");

  std::istringstream source("#include <map>\n#include \"sim/c/x.h\"\n  #include \"sim/a/y.h\"\n");
  const Arrows used{{"sim/a", folders_included(source)}};
  EXPECT_EQ(used.at("sim/a"), (std::set<std::string>{"sim/a", "sim/c"}));
  EXPECT_EQ(against_the_arrows(rooms, {{"sim/a", {"sim/c"}}}),
            std::vector<std::string>{"sim/a includes sim/c, which its line does not name"});
  EXPECT_EQ(named_in_vain({{"sim/a", {"sim/b"}}}, {}),
            std::vector<std::string>{"sim/a names sim/b, but includes nothing of it"});
  EXPECT_EQ(against_the_order_of_parts({{"workload/vio", {"sim/chip", "sim/work"}}}),
            std::vector<std::string>{"workload/vio names sim/chip; workload may not"});
}

}  // namespace
}  // namespace leviosim::tests
