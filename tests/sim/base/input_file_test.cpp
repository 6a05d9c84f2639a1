// Whole regular files, and one message for everything else. Nothing here may wait.
#include "sim/base/input_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "tests/traces/test_folder.h"

namespace leviosim::base {
namespace {

namespace fs = std::filesystem;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;
using namespace std::string_literals;

TEST(InputFile, GivesAllBytes) {
  const TempFolder folder;
  std::string bytes = "\n\0\r\xff"s;
  for (int i = 0; i < 100'000; ++i) bytes += static_cast<char>(i * 7);
  outputs::write_file_atomically(folder / "file", bytes);
  EXPECT_EQ(read_file(folder / "file", InputKind::table), bytes);
  fs::create_symlink(folder / "file", folder / "link");
  EXPECT_EQ(read_file(folder / "link", InputKind::table), bytes);
  outputs::write_file_atomically(folder / "empty", "");
  EXPECT_EQ(read_file(folder / "empty", InputKind::table), "");
}

TEST(InputFile, ReadsFilesThatDoNotSayTheirSize) {
  struct stat status {};
  ASSERT_EQ(::stat("/proc/self/status", &status), 0);
  ASSERT_EQ(status.st_size, 0);
  EXPECT_NE(read_file("/proc/self/status", InputKind::table).find("Pid:"), std::string::npos);
}

TEST(InputFile, NamesWhatIsNoRegularFile) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = (folder / "socket").string();
  ASSERT_LT(name.size(), sizeof address.sun_path);
  std::copy(name.begin(), name.end(), address.sun_path);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const auto expect = [](const fs::path& file, const std::string& reason) {
    expect_input_error([&] { read_file(file, InputKind::plan); },
                       {file.string() + ": cannot be opened as a plan: " + reason});
  };
  expect(folder / "fifo", "is a FIFO; expected a regular file");
  expect(folder / "socket", "is a socket; expected a regular file");
  expect(folder.path(), "is a folder; expected a regular file");
  expect("/dev/zero", "is a device; expected a regular file");
  fs::create_symlink("/dev/zero", folder / "zero");
  expect(folder / "zero", "is a device; expected a regular file");
  ::close(socket);
}

TEST(InputFile, GivesTheReasonOfTheSystem) {
  const TempFolder folder;
  fs::create_symlink("round", folder / "round");
  const auto expect = [](const fs::path& file, int error) {
    expect_input_error([&] { read_file(file, InputKind::image); },
                       {": cannot be opened as an image: ", std::strerror(error)});
  };
  expect(folder / "none", ENOENT);
  expect(folder / "round", ELOOP);
  expect(folder / std::string(300, 'x'), ENAMETOOLONG);
}

TEST(InputFile, BoundsTheSizeOfEachKind) {
  const TempFolder folder;
  for (const InputKind kind :
       {InputKind::platform, InputKind::plan, InputKind::sensor, InputKind::table, InputKind::image,
        InputKind::work_trace, InputKind::cached_result}) {
    const fs::path file = folder / "file";
    outputs::write_file_atomically(file, "x");
    fs::resize_file(file, static_cast<std::uintmax_t>(info_of(kind).most_bytes) + 1);  // a hole
    expect_input_error([&] { read_file(file, kind); },
                       {file.string(), "larger", info_of(kind).name, "MiB"});
  }
  const fs::path most = folder / "most";
  outputs::write_file_atomically(most, std::string(std::size_t{1} << 20, 'x'));
  EXPECT_EQ(read_file(most, InputKind::plan).size(), std::size_t{1} << 20);
}

TEST(PathKind, TellsWhatIsThere) {
  const TempFolder folder;
  outputs::write_file_atomically(folder / "file", "x");
  fs::create_symlink("nowhere", folder / "dangling");
  fs::create_symlink("round", folder / "round");
  EXPECT_EQ(kind_of(folder / "file"), PathKind::file);
  EXPECT_EQ(kind_of(folder.path()), PathKind::folder);
  EXPECT_EQ(kind_of("/dev/null"), PathKind::other);
  EXPECT_EQ(kind_of(folder / "none"), PathKind::missing);
  EXPECT_EQ(kind_of(folder / "dangling"), PathKind::missing);
  EXPECT_EQ(kind_of(folder / "file" / "below"), PathKind::missing);
  expect_input_error([&] { kind_of(folder / "round"); },
                     {"round: cannot be looked up: ", std::strerror(ELOOP)});
  expect_input_error([&] { kind_of(folder / std::string(300, 'x')); },
                     {"cannot be looked up: ", std::strerror(ENAMETOOLONG)});
}

}  // namespace
}  // namespace leviosim::base
