#include "core/atomic_file.h"

#include <csignal>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/random.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Makes every file of this process fail to grow beyond `bytes`, as a full disk would.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

/// Lays down root's right to write anywhere, where the tests run as root.
class OrdinaryUser {
 public:
  OrdinaryUser() { EXPECT_TRUE(!was_root_ || ::setresuid(kNobody, kNobody, 0) == 0); }
  ~OrdinaryUser() { EXPECT_TRUE(!was_root_ || ::setresuid(0, 0, 0) == 0); }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
  bool was_root_ = ::geteuid() == 0;
};

unsigned mode_of(const std::filesystem::path& path) {
  struct stat status {};
  ::stat(path.c_str(), &status);
  return status.st_mode & 07777u;
}

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const ScratchFolder folder;
  AtomicFile file(folder / "a.txt");
  file.write("one ");
  file.write("two");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
  file.commit();
  EXPECT_EQ(content_of(folder / "a.txt"), "one two");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, AbandonedLeavesTheOldFileAndNothingElse) {
  const ScratchFolder folder;
  put(folder / "a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.write(std::string(1 << 20, 'x'));
    EXPECT_EQ(content_of(folder / "a.txt"), "old");
  }
  EXPECT_EQ(content_of(folder / "a.txt"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, ReplacesALongerFileWhole) {
  const ScratchFolder folder;
  put(folder / "a.txt", std::string(5000, 'x'));
  AtomicFile file(folder / "a.txt");
  file.write("new");
  file.commit();
  EXPECT_EQ(content_of(folder / "a.txt"), "new");
}

TEST(AtomicFile, KeepsEveryByteOfPiecesOfAnySize) {
  const ScratchFolder folder;
  Random random(7);
  std::string expected;
  AtomicFile file(folder / "a.bin");
  for (const std::size_t size : {0, 1, 3, 262143, 262144, 262145, 100000, 200000, 600000, 17, 262144}) {
    std::string piece(size, '\0');
    for (char& byte : piece) byte = static_cast<char>(static_cast<int>(random.uniform(0.0, 256.0)) - 128);
    file.write(std::as_bytes(std::span(piece)));
    expected += piece;
  }
  file.commit();
  EXPECT_TRUE(content_of(folder / "a.bin") == expected);
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileItReplaces) {
  const ScratchFolder folder;
  put(folder / "a.txt", "old");
  ASSERT_EQ(::chmod((folder / "a.txt").c_str(), 0640), 0);
  AtomicFile file(folder / "a.txt");
  file.commit();
  EXPECT_EQ(mode_of(folder / "a.txt"), 0640u);
}

TEST(AtomicFile, GivesANewFileThePermissionsThatTheUserAsksFor) {
  const ScratchFolder folder;
  const mode_t old_mask = ::umask(027);
  AtomicFile file(folder / "a.txt");
  file.commit();
  ::umask(old_mask);
  EXPECT_EQ(mode_of(folder / "a.txt"), 0640u);
}

TEST(AtomicFile, FollowsALinkAndKeepsIt) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "store");
  put(folder / "store/real.txt", "old");
  std::filesystem::create_symlink("store/real.txt", folder / "link.txt");
  AtomicFile file(folder / "link.txt");
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(content_of(folder / "store/real.txt"), "new");
}

TEST(AtomicFile, CreatesTheFileThatADanglingLinkNames) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("real.txt", folder / "link.txt");
  AtomicFile file(folder / "link.txt");
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(content_of(folder / "real.txt"), "new");
}

TEST(AtomicFile, RefusesALinkToItself) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("loop.txt", folder / "loop.txt");
  EXPECT_THAT(message_of<Error>([&] { AtomicFile file(folder / "loop.txt"); }), HasSubstr("leads nowhere"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "loop.txt"));
}

TEST(AtomicFile, RefusesAFolderInThePlaceOfTheFile) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "a");
  EXPECT_THAT(message_of<Error>([&] { AtomicFile file(folder / "a"); }),
              AllOf(StartsWith((folder / "a").string() + ": "), HasSubstr("choose another name")));
  EXPECT_THAT(message_of<Error>([&] { AtomicFile file(folder / "a/"); }), HasSubstr("not a file name"));
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a"));
}

TEST(AtomicFile, RefusesADevice) {
  EXPECT_THAT(message_of<Error>([] { AtomicFile file("/dev/null"); }), HasSubstr("/dev/null: is not a regular file"));
}

TEST(AtomicFile, AsksForAMissingFolderToBeCreated) {
  const ScratchFolder folder;
  EXPECT_THAT(message_of<Error>([&] { AtomicFile file(folder / "missing/a.txt"); }), HasSubstr("create the folder"));
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, RefusesAFolderWithoutPermission) {
  const ScratchFolder folder;
  put(folder / "a.txt", "old");
  std::filesystem::permissions(folder / "", std::filesystem::perms(0555));
  EXPECT_THAT(message_of<Error>([&] {
                const OrdinaryUser user;
                AtomicFile file(folder / "a.txt");
              }),
              HasSubstr("cannot be"));
  EXPECT_THAT(message_of<Error>([&] {
                const OrdinaryUser user;
                AtomicFile file(folder / "b.txt");
              }),
              HasSubstr("choose a folder that you may write to"));
  std::filesystem::permissions(folder / "", std::filesystem::perms::owner_all);
  EXPECT_EQ(content_of(folder / "a.txt"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, RefusesToReplaceAFileThatIsWriteProtected) {
  const ScratchFolder folder;
  put(folder / "a.txt", "old");
  std::filesystem::permissions(folder / "", std::filesystem::perms(0777));
  std::filesystem::permissions(folder / "a.txt", std::filesystem::perms(0444));
  EXPECT_THAT(message_of<Error>([&] {
                const OrdinaryUser user;
                AtomicFile file(folder / "a.txt");
              }),
              HasSubstr("cannot be overwritten"));
  EXPECT_EQ(content_of(folder / "a.txt"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, LeavesTheOldFileWhenTheDiskIsFull) {
  // More than the buffer holds, so that writing fails, and less, so that only committing can.
  for (const std::size_t size : {1 << 20, 100000}) {
    const ScratchFolder folder;
    put(folder / "a.txt", "old");
    const std::string message = message_of<Error>([&] {
      const SmallDisk full(65536);
      AtomicFile file(folder / "a.txt");
      file.write(std::string(size, 'x'));
      file.commit();
    });
    EXPECT_THAT(message, AllOf(StartsWith((folder / "a.txt").string() + ": cannot be written"))) << size;
    EXPECT_EQ(content_of(folder / "a.txt"), "old") << size;
    EXPECT_THAT(folder.names(), ElementsAre("a.txt")) << size;
  }
}

TEST(AtomicFile, CommitsFilesThatBelongTogetherAllOrNone) {
  const ScratchFolder folder;
  put(folder / "a.txt", "old a");
  put(folder / "b.txt", "old b");
  const std::string message = message_of<Error>([&] {
    const SmallDisk full(65536);
    AtomicFile a(folder / "a.txt");
    AtomicFile b(folder / "b.txt");
    a.write("new a");
    b.write(std::string(100000, 'x'));  // stays in the buffer until the commit
    AtomicFile::commit_all({&a, &b});
  });
  EXPECT_THAT(message, HasSubstr("b.txt"));
  EXPECT_EQ(content_of(folder / "a.txt"), "old a");
  EXPECT_EQ(content_of(folder / "b.txt"), "old b");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt", "b.txt"));

  AtomicFile a(folder / "a.txt");
  AtomicFile b(folder / "b.txt");
  a.write("new a");
  b.write("new b");
  AtomicFile::commit_all({&a, &b});
  EXPECT_EQ(content_of(folder / "a.txt"), "new a");
  EXPECT_EQ(content_of(folder / "b.txt"), "new b");
}

TEST(AtomicFile, TwoWritersOfOneFileDoNotMix) {
  const ScratchFolder folder;
  AtomicFile first(folder / "a.txt");
  AtomicFile second(folder / "a.txt");
  first.write("first");
  second.write("second");
  first.commit();
  EXPECT_EQ(content_of(folder / "a.txt"), "first");
  second.commit();
  EXPECT_EQ(content_of(folder / "a.txt"), "second");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

}  // namespace
}  // namespace fathom
