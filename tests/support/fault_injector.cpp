// A library to be preloaded (LD_PRELOAD), by which one call of a kind fails: the N-th of the
// program, counted from where main() holds back signals.
//   LEVIOSIM_FAULT=KIND:N   KIND allocation, site, write, rename, open, mkdir or close; N from 1
//   LEVIOSIM_FAULT_COUNT    a file of 16 bytes: how many calls there were, and how many failed
// A site is a place that allocates, told by the callers of the allocation; its first call fails.
// What prints goes through stdio, whose writes are the C library's own and do not fail.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

struct Counts {
  std::atomic<std::uint64_t> calls;
  std::atomic<std::uint64_t> failed;
};

char kind[16];
std::uint64_t number = 0;
Counts none;
Counts* counts = &none;
std::atomic<bool> has_begun{false};
std::atomic<bool> has_output{false};
thread_local bool is_inside = false;

/// Hashes of the sites that were seen.
constexpr std::size_t kSites = 1 << 18;
std::atomic<std::uint64_t> sites[kSites];

template <class Function>
Function next(Function, const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool is_new_site() {
  constexpr int kDepth = 8;
  void* callers[kDepth];
  const int depth = ::backtrace(callers, kDepth);
  std::uint64_t hash = 1469598103934665603u;
  for (int i = 2; i < depth; ++i)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(callers[i])) * 1099511628211u;
  for (std::size_t at = hash % kSites;; at = (at + 1) % kSites) {
    std::uint64_t there = 0;
    if (sites[at].compare_exchange_strong(there, hash)) return true;
    if (there == hash) return false;
  }
}

bool fails(const char* what) {
  if (!has_begun || is_inside || std::strcmp(what, kind) != 0) return false;
  if (++counts->calls != number) return false;
  ++counts->failed;
  return true;
}

bool allocation_fails() {
  if (!has_output || is_inside) return false;
  bool result = fails("allocation");
  if (kind[0] == 's') {
    is_inside = true;  // the walk may allocate
    const bool is_new = is_new_site();
    is_inside = false;
    result = is_new && fails("site");
  }
  return result;
}

struct Setup {
  Setup() {
    is_inside = true;
    void* warm[2];
    ::backtrace(warm, 2);  // loads a library
    if (const char* const wanted = std::getenv("LEVIOSIM_FAULT")) {
      const char* const colon = std::strchr(wanted, ':');
      std::strncpy(kind, wanted, static_cast<std::size_t>(colon - wanted));
      number = std::strtoull(colon + 1, nullptr, 10);
    }
    if (const char* const file = std::getenv("LEVIOSIM_FAULT_COUNT")) {
      const int descriptor = ::open(file, O_RDWR | O_CLOEXEC);
      void* const place =
          ::mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
      if (place != MAP_FAILED) counts = static_cast<Counts*>(place);
    }
    is_inside = false;
  }
} setup;

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

int pthread_sigmask(int how, const sigset_t* set, sigset_t* old) {
  static const auto real = next(&pthread_sigmask, "pthread_sigmask");
  const int result = real(how, set, old);
  has_begun = true;
  return result;
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

#define FAULT_CALL(kind_of, error, name, arguments) \
  {                                                 \
    static const auto real = next(&name, #name);    \
    if (fails(kind_of)) {                           \
      errno = error;                                \
      return -1;                                    \
    }                                               \
    return real arguments;                          \
  }

ssize_t write(int d, const void* p, std::size_t n)
    FAULT_CALL("write", ENOSPC, write, (d, p, n)) ssize_t
    pwrite64(int d, const void* p, std::size_t n, off64_t at)
        FAULT_CALL("write", ENOSPC, pwrite64, (d, p, n, at)) ssize_t
    writev(int d, const iovec* p, int n)
        FAULT_CALL("write", ENOSPC, writev, (d, p, n)) int fallocate64(int d, int mode, off64_t at,
                                                                       off64_t n)
            FAULT_CALL("write", ENOSPC, fallocate64,
                       (d, mode, at, n)) int fallocate(int d, int mode, off_t at, off_t n)
                FAULT_CALL("write", ENOSPC, fallocate, (d, mode, at, n)) int fsync(int d)
                    FAULT_CALL("write", EIO, fsync, (d)) int fdatasync(int d)
                        FAULT_CALL("write", EIO, fdatasync, (d)) int rename(const char* a,
                                                                            const char* b) noexcept
    FAULT_CALL("rename", EIO, rename, (a, b)) int renameat(int c, const char* a, int d,
                                                           const char* b) noexcept
    FAULT_CALL("rename", EIO, renameat, (c, a, d, b)) int renameat2(int c, const char* a, int d,
                                                                    const char* b,
                                                                    unsigned f) noexcept
    FAULT_CALL("rename", EIO, renameat2, (c, a, d, b, f)) 
int mkdir(const char* a, mode_t m) noexcept {
  has_output = has_begun.load();
  FAULT_CALL("mkdir", ENOSPC, mkdir, (a, m))
}
int mkdirat(int d, const char* a, mode_t m) noexcept
    FAULT_CALL("mkdir", ENOSPC, mkdirat, (d, a, m))

        int close(int descriptor) {
  static const auto real = next(&close, "close");
  const int result = real(descriptor);  // it is closed all the same [close(2)]
  if (!fails("close")) return result;
  errno = EIO;
  return -1;
}

static mode_t mode_of(int flags, va_list more) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(more, int)) : 0;
}

#define FAULT_OPEN(name, ...)                    \
  {                                              \
    static const auto real = next(&name, #name); \
    va_list more;                                \
    va_start(more, flags);                       \
    const mode_t mode = mode_of(flags, more);    \
    va_end(more);                                \
    if (fails("open")) {                         \
      errno = EMFILE;                            \
      return -1;                                 \
    }                                            \
    return real(__VA_ARGS__, flags, mode);       \
  }
int open(const char* path, int flags, ...)
    FAULT_OPEN(open, path) int open64(const char* path, int flags, ...)
        FAULT_OPEN(open64, path) int openat(int d, const char* path, int flags, ...)
            FAULT_OPEN(openat, d, path) int openat64(int d, const char* path, int flags, ...)
                FAULT_OPEN(openat64, d, path)

}  // extern "C"
