// A library to be preloaded (LD_PRELOAD), by which one call of a kind fails: the N-th that a
// command makes, counted from where main() holds back signals. Commands are tried many thousands of
// times, so the program is started once and asks for requests at its standard input, a socket. Each
// is carried out by a copy of the process: made at the N-th call, or where the first file is opened
// to be written or the first folder made, if that comes before, or at once if nothing is to fail.
// Until then a command changes nothing.
//   request  KIND:N   KIND allocation, write, rename, open, mkdir or close; N from 1, and not below
//                     that of the request before, or 0 for none, which comes first and tells which
//                     allocations count. What is printed goes to .out, .err
//   answer   FaultAnswer (tests/support/fault_injector.h)
// What prints goes through stdio, whose writes are the C library's own and do not fail.
#include "tests/support/fault_injector.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>
#include <unwind.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>

namespace {

enum Kind { kAllocation, kWrite, kRename, kOpen, kMkdir, kClose, kKinds };
constexpr std::string_view kNames[kKinds]{"allocation", "write", "rename",
                                          "open",       "mkdir", "close"};
using Calls = std::atomic<std::uint64_t>[kKinds + 1];  // the last: how many failed

enum class Role { starting, serving, copy, none } role = Role::starting;
Calls calls_before;            // of the process that serves
Calls* calls = &calls_before;  // in copies, a place that the process sees
int kind = kKinds;             // of the request
std::uint64_t number = 0;
std::uint64_t changes = 0;  // of files, so far

/// Which allocations of the command are tried. Walking over the callers of each takes longer than
/// the command, so a copy without a fault learns it, and those after it only count.
struct Learned {
  std::atomic<bool> done;
  bool tried[1 << 24];  // by how many allocations came before
};
Learned& learned() {
  static void* const place = ::mmap(nullptr, sizeof(Learned), PROT_READ | PROT_WRITE,
                                    MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return *static_cast<Learned*>(place);
}

template <class Function>
Function next(Function, const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

void receive() {
  char request[64]{};
  if (::recv(STDIN_FILENO, request, sizeof(request) - 1, 0) <= 0) std::_Exit(0);
  const char* const colon = std::strchr(request, ':');
  if (colon == nullptr) std::_Exit(126);
  const auto* const name =
      std::find(kNames, kNames + kKinds,
                std::string_view(request, static_cast<std::size_t>(colon - request)));
  kind = static_cast<int>(name - kNames);
  number = std::strtoull(colon + 1, nullptr, 10);
}

void redirect(const char* name, int flags, int place) {
  const int file = ::open(name, flags | O_CREAT, 0600);
  ::dup2(file, place);
  ::close(file);
}

/// A place in each file of its own: a copy that reads on takes nothing away from the next.
void open_files_anew() {
  for (int file = 3; file < 256; ++file) {
    struct stat what {};
    const int flags = ::fcntl(file, F_GETFL);
    if (flags < 0 || ::fstat(file, &what) != 0 || !S_ISREG(what.st_mode)) continue;
    char name[32];
    std::snprintf(name, sizeof(name), "/proc/self/fd/%d", file);
    const int anew = ::open(name, flags & ~(O_CREAT | O_EXCL | O_TRUNC | O_NOFOLLOW));
    if (anew < 0) continue;
    ::lseek(anew, ::lseek(file, 0, SEEK_CUR), SEEK_SET);
    ::dup3(anew, file, ::fcntl(file, F_GETFD) & FD_CLOEXEC ? O_CLOEXEC : 0);
    ::close(anew);
  }
}

/// @returns whether this is the copy; the process itself has answered and has the next request
bool carry_out() {
  static void* const place =
      ::mmap(nullptr, sizeof(Calls), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  role = Role::none;
  Learned& allocations_tried = learned();  // there before the copy is
  auto& shared = *static_cast<Calls*>(place);
  for (int k = 0; k <= kKinds; ++k) shared[k] = calls_before[k].load();
  const pid_t copy = ::fork();
  if (copy == 0) {
    redirect("/dev/null", O_RDONLY, STDIN_FILENO);
    redirect(".out", O_WRONLY | O_TRUNC, STDOUT_FILENO);
    redirect(".err", O_WRONLY | O_TRUNC, STDERR_FILENO);
    open_files_anew();
    calls = &shared;
    role = Role::copy;
    return true;
  }
  FaultAnswer answer;
  ::waitpid(copy, &answer.wait_status, 0);
  if (kind == kAllocation && number == 0) allocations_tried.done = true;
  answer.calls = shared[kind];
  answer.failed = shared[kKinds];
  ::send(STDIN_FILENO, &answer, sizeof(answer), 0);
  receive();
  role = Role::serving;
  return false;
}

/// Before a change; what was asked for is carried out by copies from before the first.
void before_output() {
  ++changes;
  while (role == Role::serving)
    if (carry_out()) return;
}

bool fails(Kind what) {
  if (what == kWrite || what == kRename || what == kMkdir) before_output();
  if (role != Role::serving && role != Role::copy) return false;
  const std::uint64_t call = ++(*calls)[what];
  while (what == kind && call == number)
    if (role == Role::copy || carry_out()) {
      ++(*calls)[kKinds];
      return true;
    }
  return false;
}

constexpr std::uint64_t kMixer = 0x9e3779b97f4a7c15;

_Unwind_Reason_Code mix_in(_Unwind_Context* caller, void* hash) {
  auto& mixed = *static_cast<std::uint64_t*>(hash);
  mixed = (mixed ^ _Unwind_GetIP(caller)) * kMixer;
  mixed ^= mixed >> 29;
  return _URC_NO_REASON;
}

std::atomic<std::uint64_t> allocations = 0;  // so far

/// @returns whether no allocation before had the same callers and changes
bool is_new() {
  static std::uint64_t seen[1 << 20];  // by their hash, 0 for nothing
  std::uint64_t hash = changes + 1;
  _Unwind_Backtrace(mix_in, &hash);
  constexpr std::size_t kPlaces = std::size(seen);
  std::size_t at = hash % kPlaces;
  while (seen[at] != 0 && seen[at] != hash) at = (at + 1) % kPlaces;
  return std::exchange(seen[at], hash) == 0;
}

bool is_another() {
  static thread_local bool inside = false;
  if (inside) return false;
  const std::uint64_t at = std::min(allocations++, std::uint64_t(std::size(learned().tried) - 1));
  if (learned().done) return learned().tried[at];
  inside = true;
  const bool is = is_new();
  inside = false;
  return learned().tried[at] = is;
}

bool allocation_fails() {
  const bool may =
      kind == kAllocation && (role == Role::serving || role == Role::copy) && (*calls)[kKinds] == 0;
  return may && is_another() && fails(kAllocation);
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

int pthread_sigmask(int how, const sigset_t* set, sigset_t* old) {
  static const auto real = next(&pthread_sigmask, "pthread_sigmask");
  const int result = real(how, set, old);
  if (role == Role::starting) {
    receive();
    role = Role::serving;
    while (role == Role::serving && number == 0)
      if (carry_out()) break;
  }
  return result;
}

/// What a thread holds that locks it again is not held by its copy.
int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static const auto real = next(&pthread_mutex_lock, "pthread_mutex_lock");
  if (mutex->__data.__kind == PTHREAD_MUTEX_RECURSIVE) before_output();
  return real(mutex);
}

#define FAULT_NO_MEMORY(result) (errno = ENOMEM, result)

void* malloc(std::size_t size) {
  return allocation_fails() ? FAULT_NO_MEMORY(nullptr) : __libc_malloc(size);
}
void* calloc(std::size_t number_of, std::size_t size) {
  return allocation_fails() ? FAULT_NO_MEMORY(nullptr) : __libc_calloc(number_of, size);
}
void* realloc(void* old, std::size_t size) {
  return allocation_fails() ? FAULT_NO_MEMORY(nullptr) : __libc_realloc(old, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  if (allocation_fails()) return ENOMEM;
  *result = __libc_memalign(alignment, size);
  return *result == nullptr ? ENOMEM : 0;
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return allocation_fails() ? FAULT_NO_MEMORY(nullptr) : __libc_memalign(alignment, size);
}

/// A copy that ends gives nothing back: each page that it wrote to would have to be copied first.
void free(void* memory) {
  if (role != Role::copy || (*calls)[kKinds] == 0) __libc_free(memory);
}

#define FAULT_CALL(kind_of, error, result, name, parameters, arguments) \
  result name parameters {                                              \
    static const auto real = next(&name, #name);                        \
    if (fails(kind_of)) {                                               \
      errno = error;                                                    \
      return -1;                                                        \
    }                                                                   \
    return real arguments;                                              \
  }

// clang-format off
FAULT_CALL(kWrite, ENOSPC, ssize_t, write, (int d, const void* p, std::size_t n), (d, p, n))
FAULT_CALL(kWrite, ENOSPC, ssize_t, pwrite64, (int d, const void* p, std::size_t n, off64_t at),
           (d, p, n, at))
FAULT_CALL(kWrite, ENOSPC, ssize_t, writev, (int d, const iovec* p, int n), (d, p, n))
FAULT_CALL(kWrite, ENOSPC, int, fallocate64, (int d, int mode, off64_t at, off64_t n),
           (d, mode, at, n))
FAULT_CALL(kWrite, ENOSPC, int, fallocate, (int d, int mode, off_t at, off_t n), (d, mode, at, n))
FAULT_CALL(kWrite, EIO, int, fsync, (int d), (d))
FAULT_CALL(kWrite, EIO, int, fdatasync, (int d), (d))
FAULT_CALL(kRename, EIO, int, rename, (const char* a, const char* b), (a, b))
FAULT_CALL(kRename, EIO, int, renameat, (int c, const char* a, int d, const char* b), (c, a, d, b))
FAULT_CALL(kRename, EIO, int, renameat2, (int c, const char* a, int d, const char* b, unsigned f),
           (c, a, d, b, f))
FAULT_CALL(kMkdir, ENOSPC, int, mkdir, (const char* a, mode_t m), (a, m))
FAULT_CALL(kMkdir, ENOSPC, int, mkdirat, (int d, const char* a, mode_t m), (d, a, m))
// clang-format on

int close(int descriptor) {
  static const auto real = next(&close, "close");
  const int result = real(descriptor);  // it is closed all the same [close(2)]
  if (!fails(kClose)) return result;
  errno = EIO;
  return -1;
}

static mode_t mode_of(int flags, va_list more) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(more, int)) : 0;
}

#define FAULT_OPEN(name, parameters, ...)                             \
  int name parameters {                                               \
    static const auto real = next(&name, #name);                      \
    va_list more;                                                     \
    va_start(more, flags);                                            \
    const mode_t mode = mode_of(flags, more);                         \
    va_end(more);                                                     \
    if ((flags & (O_ACCMODE | O_CREAT)) != O_RDONLY) before_output(); \
    if (fails(kOpen)) {                                               \
      errno = EMFILE;                                                 \
      return -1;                                                      \
    }                                                                 \
    return real(__VA_ARGS__, flags, mode);                            \
  }

// clang-format off
FAULT_OPEN(open, (const char* path, int flags, ...), path)
FAULT_OPEN(open64, (const char* path, int flags, ...), path)
FAULT_OPEN(openat, (int d, const char* path, int flags, ...), d, path)
FAULT_OPEN(openat64, (int d, const char* path, int flags, ...), d, path)
// clang-format on

}  // extern "C"
