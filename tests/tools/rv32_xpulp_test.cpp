// What Xpulp spares of compiled code (tools/rv32/xpulp.h), on short pieces written by hand.
#include "tools/rv32/xpulp.h"

#include <gtest/gtest.h>

#include <vector>

namespace leviosim::rv32 {
namespace {

using Form = Instruction::Form;

Instruction with_reads(Instruction in, std::initializer_list<int> registers) {
  for (const int reg : registers)
    if (reg > 0) in.reads |= std::uint64_t{1} << reg;
  return in;
}

Instruction sum_like(Form form, int result, int first, int second) {
  Instruction in;
  in.kind = form == Form::Multiply ? Kind::Mul : Kind::Alu;
  in.form = form;
  in.written = static_cast<std::int8_t>(result);
  in.first = static_cast<std::int8_t>(first);
  in.second = static_cast<std::int8_t>(second);
  return with_reads(in, {first, second});
}
Instruction add(int result, int a, int b) { return sum_like(Form::Add, result, a, b); }
Instruction sub(int result, int a, int b) { return sum_like(Form::Subtract, result, a, b); }
Instruction mul(int result, int a, int b) { return sum_like(Form::Multiply, result, a, b); }
Instruction with_constant(Form form, int result, int operand, int constant) {
  Instruction in = sum_like(form, result, operand, -1);
  in.constant = constant;
  return in;
}
Instruction addi(int result, int a, int c) { return with_constant(Form::AddConstant, result, a, c); }
Instruction slli(int result, int a, int n) { return with_constant(Form::ShiftLeft, result, a, n); }
Instruction srai(int result, int a, int n) { return with_constant(Form::ShiftRight, result, a, n); }
Instruction load(int result, int base, int offset) {
  Instruction in;
  in.kind = Kind::Load;
  in.written = static_cast<std::int8_t>(result);
  in.base = static_cast<std::int8_t>(base);
  in.offset = offset;
  return with_reads(in, {base});
}
Instruction store(int value, int base, int offset) {
  Instruction in;
  in.kind = Kind::Store;
  in.stored = static_cast<std::int8_t>(value);
  in.base = static_cast<std::int8_t>(base);
  in.offset = offset;
  return with_reads(in, {value, base});
}
Instruction branch(int a, int b) {
  Instruction in;
  in.kind = Kind::Branch;
  return with_reads(in, {a, b});
}

/// What is spared of each instruction; Kind::Other: nothing.
std::vector<Kind> spared(std::vector<Instruction> piece) {
  find_spared(piece);
  std::vector<Kind> kinds;
  for (const Instruction& in : piece) kinds.push_back(in.spared);
  return kinds;
}
constexpr Kind kKept = Kind::Other;
using Kinds = std::vector<Kind>;

TEST(Rv32Xpulp, APointerMovesWithTheAccessBeforeIt) {
  EXPECT_EQ(spared({load(10, 8, 0), addi(8, 8, 4)}), (Kinds{kKept, Kind::SparedMove}));
  EXPECT_EQ(spared({store(10, 8, 0), add(8, 8, 9)}), (Kinds{kKept, Kind::SparedMove}));
}

TEST(Rv32Xpulp, APointerMovesWithTheAccessBehindIt) {
  EXPECT_EQ(spared({addi(8, 8, 4), load(10, 8, -4)}), (Kinds{Kind::SparedMove, kKept}));
  EXPECT_EQ(spared({addi(8, 8, 4), load(10, 8, 0)}), (Kinds{kKept, kKept}));
}

TEST(Rv32Xpulp, AnAccessMovesOnePointerOnce) {
  EXPECT_EQ(spared({load(10, 8, 0), addi(8, 8, 4), addi(8, 8, 4)}),
            (Kinds{kKept, Kind::SparedMove, kKept}));
}

TEST(Rv32Xpulp, APointerThatIsUsedInBetweenDoesNotMove) {
  EXPECT_EQ(spared({load(10, 8, 0), add(11, 8, 9), addi(8, 8, 4)}), (Kinds(3, kKept)));
  // Another access gets another offset.
  EXPECT_EQ(spared({load(10, 8, 0), load(11, 8, 8), addi(8, 8, 4)}),
            (Kinds{kKept, kKept, Kind::SparedMove}));
}

TEST(Rv32Xpulp, ALoadIntoItsOwnAddressAndTheStackPointerDoNotMove) {
  EXPECT_EQ(spared({load(8, 8, 0), addi(8, 8, 4)}), (Kinds{kKept, kKept}));
  EXPECT_EQ(spared({load(10, 2, 0), addi(2, 2, 16)}), (Kinds{kKept, kKept}));
}

TEST(Rv32Xpulp, ASumThatIsOneAddressIsPartOfTheAccess) {
  EXPECT_EQ(spared({add(10, 8, 9), load(10, 10, 0)}), (Kinds{Kind::SparedIndex, kKept}));
  EXPECT_EQ(spared({add(10, 8, 9), load(11, 10, 0), store(11, 10, 0)}), (Kinds(3, kKept)));
  EXPECT_EQ(spared({add(10, 8, 9), load(10, 10, 4)}), (Kinds{kKept, kKept}));
  EXPECT_EQ(spared({add(10, 8, 9), store(10, 10, 0)}), (Kinds{kKept, kKept}));
}

TEST(Rv32Xpulp, AProductIsAddedToOneSum) {
  EXPECT_EQ(spared({mul(10, 8, 9), add(11, 11, 10)}), (Kinds{kKept, Kind::SparedSum}));
  EXPECT_EQ(spared({mul(10, 8, 9), add(11, 10, 11)}), (Kinds{kKept, Kind::SparedSum}));
  EXPECT_EQ(spared({mul(10, 8, 9), sub(11, 11, 10)}), (Kinds{kKept, Kind::SparedSum}));
  EXPECT_EQ(spared({mul(10, 8, 9), sub(11, 10, 11)}), (Kinds{kKept, kKept}));
  EXPECT_EQ(spared({mul(10, 8, 9), add(11, 11, 10), store(10, 7, 0)}), (Kinds(3, kKept)));
}

TEST(Rv32Xpulp, TwoShiftsAreAFieldOfBits) {
  EXPECT_EQ(spared({slli(10, 8, 8), srai(10, 10, 24)}), (Kinds{Kind::SparedShift, kKept}));
  // That would be a shift to the left of some bits.
  EXPECT_EQ(spared({slli(10, 8, 8), srai(10, 10, 4)}), (Kinds{kKept, kKept}));
}

TEST(Rv32Xpulp, ASumIsShiftedAndRounded) {
  EXPECT_EQ(spared({add(10, 8, 9), srai(10, 10, 8)}), (Kinds{Kind::SparedShift, kKept}));
  EXPECT_EQ(spared({add(10, 8, 9), addi(10, 10, 128), srai(10, 10, 8)}),
            (Kinds{Kind::SparedShift, Kind::SparedShift, kKept}));
  EXPECT_EQ(spared({addi(10, 8, 100), srai(10, 10, 8)}), (Kinds{kKept, kKept}));
}

TEST(Rv32Xpulp, AnInstructionDoesTheWorkOfOneOther) {
  EXPECT_EQ(spared({mul(10, 8, 9), add(11, 11, 10), srai(12, 11, 8)}),
            (Kinds{kKept, Kind::SparedSum, kKept}));
}

TEST(Rv32Xpulp, ACounterThatOnlyRepeatsTheLoopIsTheHardwares) {
  EXPECT_EQ(spared({mul(10, 8, 9), addi(5, 5, -1), branch(5, 0)}),
            (Kinds{kKept, Kind::LoopCounter, kKept}));
  // The index of an access is needed anyway.
  EXPECT_EQ(spared({add(10, 8, 5), addi(5, 5, 1), branch(5, 6)}), (Kinds(3, kKept)));
  // A pointer that ends the loop moves with its access.
  EXPECT_EQ(spared({load(10, 8, 0), addi(8, 8, 4), branch(8, 9)}),
            (Kinds{kKept, Kind::SparedMove, kKept}));
}

}  // namespace
}  // namespace leviosim::rv32
