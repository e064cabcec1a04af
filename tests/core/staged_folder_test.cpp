#include "core/staged_folder.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

using Names = std::vector<std::string>;

TEST(StagedFolder, ShowsNothingBeforeTheCommitAndEverythingAfter) {
  const ScratchFolder scratch;
  StagedFolder staged(scratch / "out/");
  put(staged.path() / "a", "new");
  put(staged.path() / "b", "new");
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
  staged.commit();
  EXPECT_EQ(content_of(scratch / "out/a"), "new");
  EXPECT_EQ(content_of(scratch / "out/b"), "new");
}

TEST(StagedFolder, LeavesNothingBehindWhenTheWorkFails) {
  const ScratchFolder scratch;
  {
    StagedFolder staged(scratch / "out");
    put(staged.path() / "a", "half");
  }
  EXPECT_EQ(scratch.names(), Names{});
}

TEST(StagedFolder, ReplacesItsOwnFilesAndLeavesOthersAlone) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "out");
  put(scratch / "out/a", "old");
  put(scratch / "out/notes", "mine");
  {
    StagedFolder staged(scratch / "out");
    put(staged.path() / "a", "new");
    staged.commit();
  }
  EXPECT_EQ(content_of(scratch / "out/a"), "new");
  EXPECT_EQ(content_of(scratch / "out/notes"), "mine");
  EXPECT_EQ(scratch.names(), Names{"out"});
}

TEST(StagedFolder, RefusesAFileInItsPlaceAndFoldersInThePlaceOfItsFiles) {
  const ScratchFolder scratch;
  put(scratch / "file", "mine");
  EXPECT_NE(message_of<Error>([&] { StagedFolder(scratch / "file"); }).find("is not a folder"), std::string::npos);
  EXPECT_EQ(content_of(scratch / "file"), "mine");

  std::filesystem::create_directories(scratch / "out/b");
  StagedFolder staged(scratch / "out");
  put(staged.path() / "a", "new");
  put(staged.path() / "b", "new");
  EXPECT_THROW(staged.commit(), Error);
  EXPECT_FALSE(std::filesystem::exists(scratch / "out/a"));
}

TEST(StagedFolder, NeedsAFolderThatIsThere) {
  const ScratchFolder scratch;
  EXPECT_THROW(StagedFolder(scratch / "missing/out"), Error);
}

}  // namespace
}  // namespace fathom
