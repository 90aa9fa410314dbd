#include "map/voxel_sums_table.h"

#include <gtest/gtest.h>

namespace saw_ndt {
namespace {

TEST(VoxelSumsTable, EntriesStayWhereTheyAre) {
  internal::VoxelSumsTable table;
  table.entry(table.placeOf({1, 2, 3}, StructuralLabel::GROUND)).sums.add({1, 1, 1});
  const LabelledVoxelSums* const first = &table.entry(0);
  for (int i = 0; i < 100000; ++i) table.placeOf({i, 0, 0}, StructuralLabel::NOISE);
  EXPECT_EQ(table.size(), 100001U);
  EXPECT_EQ(&table.entry(0), first);
  EXPECT_EQ(table.find({1, 2, 3}, StructuralLabel::GROUND), first);
  // A copy has its own, and goes on by itself.
  internal::VoxelSumsTable copy = table;
  EXPECT_NE(&copy.entry(0), first);
  EXPECT_EQ(copy.placeOf({77, 0, 0}, StructuralLabel::NOISE), 78U);
  EXPECT_EQ(copy.placeOf({-1, 0, 0}, StructuralLabel::NOISE), 100001U);
  EXPECT_EQ(table.size(), 100001U);
  EXPECT_EQ(copy.takeEntries().size(), 100002U);
  EXPECT_EQ(copy.size(), 0U);
}

}  // namespace
}  // namespace saw_ndt
