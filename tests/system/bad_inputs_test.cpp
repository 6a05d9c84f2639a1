// The bad inputs of bad_input_rows.h must all be refused with status 2 before any work is done,
// within two seconds of processor time and 300 MB, and leave the folder as it was.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <map>

#include "tests/support/run_program.h"
#include "tests/system/bad_input_rows.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using bad_inputs::Arguments;
using bad_inputs::Row;
using traces::testing::AslFolder;
using traces::testing::TempFolder;

/// Names, kinds and contents of all that is in a folder.
std::map<std::string, std::string> listing(const fs::path& folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name =
        fs::relative(entry.path().parent_path(), folder) / entry.path().filename();
    if (entry.is_symlink())
      found[name] = "-> " + fs::read_symlink(entry.path()).string();
    else if (entry.is_regular_file())
      found[name] = base::read_text_file(entry.path());
    else
      found[name] = entry.is_directory() ? "folder" : "special";
  }
  return found;
}

class BadInputs : public ::testing::TestWithParam<Row> {
 protected:
  /// One recorded run for all rows.
  static void SetUpTestSuite() {
    recorded_ = fs::temp_directory_path() / fmt::format("leviosim-{}-bad-inputs", ::getpid());
    const fs::path& folder = recorded_;
    fs::create_directories(folder);
    traces::write_synthetic_flight(folder / "flight", {.duration_s = 0.5, .texel_m = 0.05});
    const auto result = testing::run_program(
        folder, {"run", "--platform", "gap9", "--data", (folder / "flight").string(), "--record",
                 "--out", (folder / "run").string(), "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
  }
  static void TearDownTestSuite() { fs::remove_all(recorded_); }

  std::string filled_in(std::string word) const {
    const std::pair<std::string, std::string> kPlaces[] = {
        {"@D", data_.root().string()},
        {"@F", folder_.path().string()},
        {"@T", (recorded_ / "run/work.trace").string()},
        {"@E", (recorded_ / "run/trajectory.tum").string()}};
    for (const auto& [place, value] : kPlaces)
      for (auto at = word.find(place); at != std::string::npos; at = word.find(place))
        word.replace(at, place.size(), value);
    return word;
  }

  static fs::path recorded_;
  TempFolder folder_;
  TempFolder output_;
  AslFolder data_;
};
fs::path BadInputs::recorded_;

// Sanitizers take memory of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kMostData = 0;
#else
constexpr std::uint64_t kMostData = 300'000'000;
#endif

TEST_P(BadInputs, IsRefused) {
  const Row& row = GetParam();
  if (row.setup) row.setup(folder_.path(), data_);
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    if (entry.path().extension() == ".yaml" && entry.is_regular_file()) {
      const std::string text = filled_in(base::read_text_file(entry.path()));
      std::ofstream(entry.path(), std::ios::binary) << text;
    }
  Arguments words;
  for (const std::string& word : row.words) words.push_back(filled_in(word));
  const auto before = listing(folder_.path());
  const auto data_before = listing(data_.root());

  testing::Program program(output_.path(), words, {.cpu_seconds = 2, .data_bytes = kMostData});
  const testing::ProgramResult result = program.wait();

  testing::expect_refused(result, row.message);
  EXPECT_EQ(before, listing(folder_.path()));
  EXPECT_EQ(data_before, listing(data_.root()));
  for (const char c : result.err)
    EXPECT_TRUE(c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f))
        << "a control character reaches the terminal: " << int{c};
}

std::string row_name(const ::testing::TestParamInfo<Row>& info) {
  return fmt::format("{}{}", info.param.name, info.index);
}
INSTANTIATE_TEST_SUITE_P(Rows, BadInputs, ::testing::ValuesIn(bad_inputs::all_rows()), row_name);

TEST(BadInputsTable, HasEnoughRows) { EXPECT_GE(bad_inputs::all_rows().size(), 80u); }

}  // namespace
}  // namespace leviosim::tools
