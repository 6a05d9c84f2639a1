// Kernels that go round the work counters, for tests/tools/check_counting_test.py: each line with a
// comment `trap: …` is one, and nothing else here is. Compiled by nobody.
#include <array>
#include <cstring>

#include "sim/work/functions.h"
#include "sim/work/policy.h"

namespace traps {

using namespace leviosim;

template <class P>
struct Kernels {
  using I = typename P::I32;
  using Byte = typename P::Byte;
  template <class T>
  using Span = typename P::template Span<T>;

  static I reads_raw(Span<const Byte> row) {
    I sum = 0;
    for (int x : P::range(0, row.size()))
      sum += I(static_cast<int>(row.data()[x]));  // trap: a view's memory
    return sum;
  }

  static void writes_raw(Span<Byte> to, Span<const Byte> from) {
    std::memcpy(to.data(), &from, 4);  // trap: a view's memory
  }

  static I reads_pointer(const Byte* pixels, int count) {
    I sum = 0;
    for (int x : P::range(0, count))
      sum += I(static_cast<int>(pixels[x]));  // trap: a plain pointer
    return sum;
  }

  static I looks_up(Span<const Byte> row) {
    static const int squares[256] = {};
    I sum = 0;
    for (int x : P::range(0, row.size()))
      sum += I(squares[work::value(I(row[x]))]);  // trap: an array that counts no load
    return sum;
  }

  static I hides_data(Span<const Byte> row, I place) {
    const int at = work::value(place);
    return I(row[at + 1]);  // trap: work::value() in an index
  }

  static I computes_plainly(Span<const Byte> row, int step) {
    I sum = 0;
    for (int x : P::range(0, row.size()))
      sum += I(row[x * step % row.size()]);  // trap: index arithmetic
    return sum;
  }

  static I iterates_plainly(Span<const Byte> row, int n) {
    I sum = 0;
    for (int x = 0; x < n; ++x) sum += I(row[x]);         // trap: a loop on plain numbers
    for (int x = row.size(); x > 0; x -= 2) sum += I(1);  // trap: a loop on plain numbers
    int left = n;
    while (left-- > 0) sum += I(1);  // trap: a loop on plain numbers
    do sum += I(1);                  // trap: a loop on plain numbers
    while (++left < n);
    return sum;
  }

  /// Unrolled, or counted by what is compared.
  template <int N>
  static I iterates_as_code_says(Span<const Byte> row) {
    constexpr int most = 4;
    std::array<I, 3> sums{};
    I sum = 0;
    for (int x = 0; x < N; ++x) sum += I(row[x]);
    for (int x = 0; x < 2 * most + 1; ++x)
      for (int y = 0; y <= x; ++y) sum += I(row[x]);
    for (std::size_t i = 0; i < sums.size(); ++i) sum += sums[i];
    while (sum > I(3)) sum = sum - I(2);
    return sum;
  }

  /// What is allowed.
  static I counts(Span<const Byte> row, Span<I> sums, I place, int width) {
    const Span<const Byte> part(row.data() + width, width);
    const int names = work::value(place);
    // uncounted: the host's own table, which the target has in its instructions
    int registers[4] = {0, 1, 2, 3};
    typename P::template Array<I, 8> held{};
    I sum = 0;
    for (int y : P::range(0, 2))
      for (int x : P::range(0, width)) sum += I(part[y * width + x]) + I(row[place]);
    for (int i = 0; i < 4; ++i) sum += I(registers[i]);
    for (int i : P::range(0, names)) held[i] = sum;
    sums[I(place + I(1))] = I(row[I(place / I(2))]);
    sum += iterates_as_code_says<3>(row);
    return sum + I(static_cast<int>(row.data()[0]));  // uncounted: a check of the host
  }
};

template struct Kernels<work::Counting>;
template struct Kernels<work::Native>;

}  // namespace traps
