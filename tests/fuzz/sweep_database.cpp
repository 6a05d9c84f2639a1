// Data bases of sweeps, with a journal beside them if a second part follows. The reader makes no
// other file disappear.
#include <sqlite3.h>

#include "tests/fuzz/fuzz_target.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace {

namespace fs = std::filesystem;
using namespace leviosim;  // NOLINT: a program of one file

void write(const fs::path& file, std::string_view bytes) {
  const int opened = ::open(file.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
  if (opened < 0 || ::write(opened, bytes.data(), bytes.size()) != std::ssize(bytes)) std::abort();
  ::close(opened);
}

/// Everything that commands ask a sweep that is not theirs.
void read(const fs::path& folder, tools::Database::Mode mode) {
  tools::SweepStore store(folder, mode);
  store.planned();
  store.parameter_names();
  store.place();
  store.plan_text();
  for (const tools::SweepOutcome& outcome : store.outcomes()) {
    store.result_of(outcome.point);
    store.settings_of(outcome.point);
    store.key_of(outcome.point);
  }
  store.front();
  store.csv();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Memory that SQLite takes in advance costs ten times the reading.
  static const int lean = sqlite3_config(SQLITE_CONFIG_LOOKASIDE, 0, 0) +
                          sqlite3_config(SQLITE_CONFIG_PAGECACHE, nullptr, 0, 0);
  if (lean != SQLITE_OK) std::abort();
  static const fuzz::MemoryFile neighbour("-sweep/thesis.tex");
  static const fs::path folder = neighbour.path().parent_path();
  const fs::path victim = "/dev/shm/leviosim-fuzz-victim";  // which journals among the seeds name
  const std::vector<std::string> parts = fuzz::parts_of(fuzz::text_of(data, size));
  write(victim, "mine");
  for (const auto mode : {tools::Database::Mode::existing, tools::Database::Mode::read_only}) {
    write(folder / tools::kSweepFile, parts[0]);
    const fs::path journal = folder / (std::string(tools::kSweepFile) + "-journal");
    if (parts.size() > 1)
      write(journal, parts[1]);
    else
      ::unlink(journal.c_str());
    fuzz::only_input_errors([&] { read(folder, mode); });
    if (::access(victim.c_str(), F_OK) != 0 || ::access(neighbour.path().c_str(), F_OK) != 0)
      std::abort();
    if (parts.size() == 1) break;  // only journals are treated otherwise
  }
  return 0;
}
