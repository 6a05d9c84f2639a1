#include "tools/app/cli/host.h"
#include "tools/app/cli/cache_folder.h"
#include "tools/app/cli/child_programs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/outputs/file_system.h"

namespace leviosim::tools {
namespace {

/// Shells start background jobs with SIGINT ignored; one that is sent all the same is meant.
bool stays_ignored(int signal) {
  if (signal != SIGHUP && signal != SIGPIPE) return false;
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// A child that was started, with the signals that a new process has.
pid_t started(std::vector<std::string> words, posix_spawn_file_actions_t* files) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = -1;
  const int error =
      posix_spawnp(&child, arguments.front(), files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(files);
  if (error != 0)
    throw InputError(fmt::format("{}: cannot be run: {}", words.front(),
                                 std::generic_category().message(error)));
  return child;
}

/// Passes a request to stop on to the child, which may have something to put in order first.
/// @param passed  whether that was done
void pass_on(pid_t child, bool& passed) {
  const int signal = pending_interrupt();
  if (signal == 0 || passed) return;
  ::kill(child, signal == SIGPIPE ? SIGTERM : signal);
  passed = true;
}

int status_of(pid_t child) {
  using std::chrono::microseconds;
  constexpr microseconds kLongest{20'000};
  int status = 0;
  bool passed = false;
  for (microseconds wait{200};; wait = std::min(2 * wait, kLongest)) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) break;
    pass_on(child, passed);
    std::this_thread::sleep_for(wait);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

namespace fs = std::filesystem;

constexpr const char* kWayOut = "set XDG_CACHE_HOME to a folder of yours";

/// Where others can make folders, too: one that nobody else can read or write.
fs::path private_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw InputError(fmt::format("{}: cannot be created: {}; {}", folder.string(),
                                 outputs::reason(errno), kWayOut));
  const std::optional<struct stat> status = outputs::status_of(folder);
  if (!status || !S_ISDIR(status->st_mode) || status->st_uid != ::geteuid() ||
      (status->st_mode & 077) != 0)
    throw InputError(fmt::format(
        "{}: is not a folder that only you can use, and there is no other place for the cache; {}",
        folder.string(), kWayOut));
  return folder;
}

/// It may be a link, as people move their caches to other disks.
fs::path users_folder(const fs::path& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) == 0 && status.st_uid != ::geteuid())
    throw InputError(fmt::format("{}: belongs to another user; {}", folder.string(), kWayOut));
  return folder;
}

}  // namespace

void provide_stack() {
  constexpr rlim_t kNeeded = rlim_t{1} << 20;  // the deepest calls take a fifth of it
  rlimit limit;
  if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kNeeded) return;
  const rlim_t found = limit.rlim_cur;
  limit = {kNeeded, std::max(limit.rlim_max, kNeeded)};
  pthread_attr_t attributes;
  if (::setrlimit(RLIMIT_STACK, &limit) != 0 || pthread_attr_init(&attributes) != 0)
    throw InputError(
        fmt::format("the stack may have {} KiB; expected a limit of at least {} KiB: ulimit -s",
                    found >> 10, kNeeded >> 10));
  pthread_attr_setstacksize(&attributes, kNeeded);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
}

DeferredInterrupts::DeferredInterrupts() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : interrupting_signals())
    if (!stays_ignored(signal)) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

DeferredInterrupts::~DeferredInterrupts() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

int run_child(const std::vector<std::string>& words, bool quiet) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (quiet)
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  else
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
  const int status = status_of(started(words, &files));
  throw_if_interrupted();
  return status;
}

std::string output_of(const std::vector<std::string>& words) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  try {
    child = started(words, &files);
  } catch (const InputError&) {
    ::close(ends[0]);
    ::close(ends[1]);
    return {};
  }
  ::close(ends[1]);
  std::string text;
  std::array<char, 4096> part{};
  bool passed = false;
  for (;;) {
    constexpr int kMillisecondsPerPoll = 20;
    pollfd readable{ends[0], POLLIN, 0};
    if (::poll(&readable, 1, kMillisecondsPerPoll) == 0) {
      pass_on(child, passed);
      continue;
    }
    const ssize_t n = ::read(ends[0], part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    text.append(part.data(), static_cast<std::size_t>(n));
  }
  ::close(ends[0]);
  if (status_of(child) != 0) return {};
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

fs::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg == '/')
    return users_folder(fs::path(xdg) / "leviosim");
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return users_folder(fs::path(home) / ".cache/leviosim");
  return private_folder(fs::temp_directory_path() / fmt::format("leviosim-{}", ::geteuid()));
}

}  // namespace leviosim::tools
