#include "core/text_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

using testing::HasSubstr;

TEST(TextFile, ReadsBackWhatWasWritten) {
  const ScratchFolder folder;
  const std::string text("a\r\n\0b\xff", 6);
  write_text_file(folder / "a.txt", text);
  EXPECT_EQ(read_text_file(folder / "a.txt", 6), text);
}

TEST(TextFile, LongerThanAllowedIsRefused) {
  const ScratchFolder folder;
  put(folder / "a.txt", std::string(11 << 20, ' '));
  EXPECT_THAT(message_of<Error>([&] { read_text_file(folder / "a.txt", 10 << 20); }), HasSubstr("11 MB long"));
}

TEST(TextFile, MustBeARegularFile) {
  EXPECT_THAT(message_of<Error>([] { read_text_file("/dev/zero", 10); }), HasSubstr("/dev/zero: is not a file"));
}

}  // namespace
}  // namespace fathom
