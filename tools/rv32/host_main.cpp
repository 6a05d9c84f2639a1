// counts INPUTS: the scenes on counted scalars. Prints a line per scene, function and operation:
// "counted" of the function itself, "inclusive" with all that it called.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include RV32_SCENES

namespace leviosim::rv32 {
namespace {

struct Account {
  std::uint64_t visits = 0;
  work::Counts counts;
  work::Counts inclusive;  ///< with what it called; no named function calls itself
};

/// Who ran how often and did what; the accounts of the functions that are running, innermost last.
struct Ledger {
  std::map<std::pair<std::string, std::string>, Account> accounts;
  std::vector<Account*> running;
  std::string scene;

  bool measuring() const { return !running.empty() && running.back() != nullptr; }
  void settle() {
    const work::Counts counts = work::take_tally();
    if (!measuring()) return;
    running.back()->counts += counts;
    for (Account* account : running) account->inclusive += counts;
  }
};

Ledger& ledger() {
  static Ledger instance;
  return instance;
}

void print(const char* what, const std::pair<std::string, std::string>& key,
           const work::Counts& counts) {
  for (const work::OpInfo& info : work::kOps)
    if (counts[info.op] > 0)
      std::printf("%s\t%s\t%s\t%.*s\t%llu\n", what, key.first.c_str(), key.second.c_str(),
                  static_cast<int>(info.name.size()), info.name.data(),
                  static_cast<unsigned long long>(counts[info.op]));
}

}  // namespace

bool is_scene(const char* name) { return std::strncmp(name, "scene: ", 7) == 0; }

void enter_function(const char* name) {
  Ledger& l = ledger();
  l.settle();
  if (is_scene(name)) {
    l.scene = name;
  } else if (!l.measuring()) {  // preparation of a scene
    l.running.push_back(nullptr);
    return;
  }
  Account& account = l.accounts[{l.scene, name}];
  ++account.visits;
  l.running.push_back(&account);
}

void leave_function() {
  Ledger& l = ledger();
  l.settle();
  l.running.pop_back();
}

}  // namespace leviosim::rv32

int main(int argc, char** argv) {
  using namespace leviosim;
  if (argc != 2) {
    std::fprintf(stderr, "usage: counts INPUTS\n");
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<char> inputs((std::istreambuf_iterator<char>(in)), {});
  if (inputs.empty()) {
    std::fprintf(stderr, "counts: %s is empty or missing\n", argv[1]);
    return 2;
  }
  rv32::Scenes<work::Counting> scenes(reinterpret_cast<const unsigned char*>(inputs.data()));
  scenes.run();
  for (const auto& [key, account] : rv32::ledger().accounts) {
    std::printf("counted\t%s\t%s\tvisits\t%llu\n", key.first.c_str(), key.second.c_str(),
                static_cast<unsigned long long>(account.visits));
    rv32::print("counted", key, account.counts);
    rv32::print("inclusive", key, account.inclusive);
  }
  for (const vio::FrameReport& r : scenes.reports())
    std::fprintf(stderr, "%d %d %d %d %d %d %d\n", static_cast<int>(r.source), r.keyframe,
                 r.features, r.world_matches, r.frame_matches, r.inliers, r.landmarks);
  return 0;
}
