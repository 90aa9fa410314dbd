#include "common/instruction_set.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace saw_ndt {

using namespace internal;

namespace {

class InstructionSetTest : public testing::Test {
 protected:
  void TearDown() override { limitInstructionSet(InstructionSet::AVX512); }
};

TEST_F(InstructionSetTest, NamesAndBack) {
  for (const InstructionSet set : kInstructionSets) {
    EXPECT_EQ(instructionSetNamed(toString(set)), set);
  }
  EXPECT_THROW(instructionSetNamed("sse9"), std::invalid_argument);
  EXPECT_THROW(instructionSetNamed(""), std::invalid_argument);
}

TEST_F(InstructionSetTest, IsNeverBeyondItsLimit) {
  for (const InstructionSet most : kInstructionSets) {
    limitInstructionSet(most);
    EXPECT_LE(instructionSet(), most);
  }
  limitInstructionSet(InstructionSet::BASELINE);
  EXPECT_EQ(instructionSet(), InstructionSet::BASELINE);
}

TEST_F(InstructionSetTest, LiftingTheLimitBringsTheBestBack) {
  const InstructionSet best = (limitInstructionSet(InstructionSet::AVX512), instructionSet());
  limitInstructionSet(InstructionSet::BASELINE);
  limitInstructionSet(InstructionSet::AVX512);
  EXPECT_EQ(instructionSet(), best);
}

// In a process of its own, since the variable is read once.
int exitCodeWith(const std::string& value) {
  setenv("SAW_NDT_INSTRUCTION_SET", value.c_str(), 1);
  try {
    return instructionSet() == instructionSetNamed(value) ? 0 : 1;
  } catch (const std::invalid_argument& error) {
    return std::string(error.what()).find("SAW_NDT_INSTRUCTION_SET") != std::string::npos ? 2 : 3;
  }
}

TEST(InstructionSetDeathTest, ObeysTheEnvironment) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(std::exit(exitCodeWith("baseline")), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(std::exit(exitCodeWith("fastest")), testing::ExitedWithCode(2), "");
}

}  // namespace
}  // namespace saw_ndt
